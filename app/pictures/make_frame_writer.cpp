#include "app/pictures/make_frame_writer.h"

#include "app/pictures/video_writer.h"
#include "app/text/frame_names.h"
#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/images/image_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <system_error>
#include <vector>

#include <fmt/format.h>

namespace relume {
namespace {

namespace fs = std::filesystem;

/// Writes frame_0001.png and so on into a folder.
class FolderWriter final : public FrameWriter {
public:
    explicit FolderWriter(const Desc& desc) : folder_(desc.path) {
        while (folder_.size() > 1 && folder_.ends_with('/'))
            folder_.pop_back();
        if (!checkFolderWritable(folder_)) return;
        old_ = oldFrames();
        if (!old_.empty() && !desc.overwrite) {
            throw Error(folder_ + ": holds frames (" + old_.front().filename().string() +
                        "): name another folder, or pass --overwrite to lose them");
        }
        for (const fs::path& frame : old_)
            checkFileWritable(frame.string(), 0);
    }

    void write(const FloatImage& frame, uint32_t times) override {
        if (count_ == 0) begin();
        const std::string png = encodePng(frame, folder_);
        for (uint32_t i = 0; i < times; ++i)
            writeFileAtomically(fmt::format("{}/frame_{:04}.png", folder_, ++count_), png, OnFailure::Drop);
    }
    std::string finish() override { return folder_; }
    bool keepsFrames() const override { return true; }

private:
    std::vector<fs::path> oldFrames() const {
        std::vector<fs::path> frames;
        std::error_code code;
        for (const fs::directory_entry& entry : fs::directory_iterator(folder_, code))
            if (isFrameName(entry.path().filename().string())) frames.push_back(entry.path());
        if (code) throw Error(folder_ + ": cannot be read: " + code.message() + ": name another folder");
        std::sort(frames.begin(), frames.end());
        return frames;
    }
    // A shorter series than the one before it must not end in that one's frames.
    void begin() {
        made_.emplace(folder_);
        std::error_code code;
        for (const fs::path& frame : old_)
            fs::remove(frame, code); // what cannot be removed cannot be replaced either, which is told then
    }

    std::string folder_;
    std::optional<FolderForFiles> made_; // goes again where no frame could be written
    std::vector<fs::path> old_;
};

} // namespace

void checkSeries(const FrameWriter::Desc& desc) {
    const std::string& path = desc.path;
    // A folder's name may have a dot, but hardly one of these endings.
    constexpr std::array kEndings = {".avi", ".mkv", ".mov", ".webm", ".gif", ".png", ".jpg", ".exr"};
    for (const char* ending : kEndings)
        if (path.ends_with(ending))
            throw UsageError("--output: '" + path + "': name a folder for the frames, or FILE.mp4");
    if (path.empty()) throw UsageError("--output: is empty: name a folder for the frames, or FILE.mp4");
    if (!isVideo(path)) return;
    if (desc.width % 2 != 0 || desc.height % 2 != 0)
        throw UsageError(
            fmt::format("--size: '{}x{}': a video's width and height are even", desc.width, desc.height));
    if (desc.overwrite) throw UsageError("--overwrite: only for a folder, a video is replaced as it is");
}

std::unique_ptr<FrameWriter> makeFrameWriter(const FrameWriter::Desc& desc) {
    if (isVideo(desc.path)) return std::make_unique<VideoWriter>(desc);
    return std::make_unique<FolderWriter>(desc);
}

} // namespace relume
