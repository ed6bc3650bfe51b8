// This tests that a file is converted in a process of its own, and what is told where that fails. The program
// that the tests start is RELUME_BINARY.
#include "assets/foreign/foreign_import.h"

#include "assets/base/error.h"
#include "assets/base/watch.h"
#include "assets/base/worker_pool.h"
#include "assets/foreign/blender_export.h"
#include "assets/foreign/foreign_scene.h"
#include "assets/foreign/load_scene.h"
#include "assets/gltf/gltf.h"
#include "tests/unit/foreign_files.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <sstream>

#include <gtest/gtest.h>

namespace relume {
namespace {

using test::writeFile;

ImportDesc descOf(const std::string& path) {
    ImportDesc desc;
    desc.path = path;
    desc.program = RELUME_BINARY;
    return desc;
}

std::string errorOf(const ImportDesc& desc) {
    try {
        importForeign(desc);
    } catch (const Error& error) {
        const std::string line = error.what();
        EXPECT_TRUE(line.starts_with(desc.path + ": ")) << line;
        EXPECT_EQ(line.find('\n'), std::string::npos) << line;
        return line;
    }
    return "none";
}

std::string contentOf(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

/// Makes a program that stands in for the converter.
std::string script(const TemporaryFolder& folder, const std::string& text) {
    const std::string path = writeFile(folder, "converter.sh", "#!/bin/sh\n" + text + "\n");
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(ForeignImport, TheChildWritesWhatTheConversionMakes) {
    const TemporaryFolder folder;
    const std::string path = writeFile(folder, "room.dae", test::kRoomDae);
    const ImportedFile file = importForeign(descOf(path));
    file.save(folder.path("room.glb"));
    const ForeignScene made = convertForeign(path);
    const std::vector<uint8_t> bytes = glbBytes(made.scene, made.pictures);
    EXPECT_EQ(contentOf(folder.path("room.glb")), std::string(bytes.begin(), bytes.end()));
    EXPECT_EQ(file.warnings(), made.scene.warnings); // of the ambient light
    ASSERT_EQ(file.warnings().size(), 1u);

    const Scene scene = loadImported(path, file);
    EXPECT_EQ(scene.path, path);
    EXPECT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.warnings.front(), file.warnings().front());
    // Nothing is left beside it.
    EXPECT_EQ(folder.files(), (std::vector<std::string>{"room.dae", "room.glb"}));
}

TEST(ForeignImport, EveryEndOfTheChildIsToldInOneLine) {
    const TemporaryFolder folder;
    ImportDesc desc = descOf(writeFile(folder, "floor.obj", test::kFloorObj));
    desc.program = script(folder, "kill -SEGV $$");
    EXPECT_TRUE(contains(errorOf(desc), "libassimp failed while it read this .obj file (signal 11"));
    desc.program = script(folder, "kill -XCPU $$");
    EXPECT_TRUE(contains(errorOf(desc), "takes longer than 300 s"));
    desc.program = script(folder, "echo d >&4; exit 3"); // it says that all is well, and fails
    EXPECT_TRUE(contains(errorOf(desc), "exit status 3"));
    desc.program = script(folder, "printf 'p0.5\\ne%s: is bad: mend it\\n' \"${9}\" >&4; exit 1");
    EXPECT_TRUE(contains(errorOf(desc), "floor.obj: is bad: mend it"));
    desc.program = script(folder, "exec 4>&-; sleep 600"); // it is silent and goes on
    desc.limits.seconds = 0.05;
    EXPECT_TRUE(contains(errorOf(desc), "takes longer than 0.05 s: allow more by 'relume import"));
    desc.program = folder.path("missing");
    EXPECT_TRUE(contains(errorOf(desc), "does not start"));
    EXPECT_TRUE(contains(errorOf(descOf(writeFile(folder, "odd.fbx", "no scene"))), "cannot be read"));
}

struct Stopped {};

class Stopper final : public Watch {
public:
    explicit Stopper(std::function<bool()> isTime) : isTime_(std::move(isTime)), scope_(*this) {}
    void hear(const char* phase, double) override {
        heard = phase;
        if (isTime_()) throw Stopped();
    }
    std::string heard;

private:
    std::function<bool()> isTime_;
    WatchScope scope_;
};

TEST(ForeignImport, WhoeverEndsTheJobEndsTheChild) {
    const TemporaryFolder folder;
    ImportDesc desc = descOf(writeFile(folder, "floor.obj", test::kFloorObj));
    const std::string told = folder.path("pid");
    desc.program =
        script(folder, "echo $$ > " + told + ".part; mv " + told + ".part " + told + "; exec sleep 600");
    const Stopper stopper([&] { return std::filesystem::exists(told); });
    EXPECT_THROW(importForeign(desc), Stopped);
    EXPECT_EQ(stopper.heard, "importing");
    EXPECT_EQ(kill(std::stoi(contentOf(told)), 0), -1);
    EXPECT_EQ(errno, ESRCH);
}

TEST(ForeignImport, MemoryIsLimited) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers reserve more address space than any limit";
#endif
    const TemporaryFolder folder;
    // A file that claims 100 million vertices, for which libassimp takes 1.2 GB at once.
    ImportDesc desc =
        descOf(writeFile(folder, "big.off", "OFF\n100000000 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
    desc.limits.memory = uint64_t{64} << 20;
    EXPECT_TRUE(contains(errorOf(desc), "takes more than 0.0625 GiB of memory: allow more by"))
        << errorOf(desc);
}

TEST(ForeignImport, MutatedFilesEndInAnErrorOrAScene) {
    const TemporaryFolder folder;
    const auto files = test::filesToMutate();
    constexpr uint32_t kMutations = 15; // of each; foreign_scene_test.cpp has many more
    std::atomic<uint32_t> scenes = 0, errors = 0;
    WorkerPool pool(0);
    pool.run(static_cast<uint32_t>(files.size()) * kMutations, [&](uint32_t i) {
        const auto& [ending, text] = files[i / kMutations];
        ImportDesc desc = descOf(writeFile(folder, std::to_string(i) + ending, test::mutated(text, i)));
        desc.limits.memory = uint64_t{256} << 20;
        try {
            const ImportedFile file = importForeign(desc);
            loadImported(desc.path, file);
            ++scenes;
        } catch (const Error& error) {
            EXPECT_TRUE(std::string(error.what()).starts_with(desc.path + ": ")) << error.what();
            ++errors;
        }
    });
    EXPECT_EQ(scenes + errors, files.size() * kMutations);
}

TEST(BlenderExport, TellsWhichModuleOfPythonIsMissing) {
    const TemporaryFolder folder;
    const std::string room = writeFile(folder, "room.blend", "BLENDER");
    const auto told = [&](const std::string& complaint) -> std::string {
        try {
            exportByBlender(script(folder, "echo \"" + complaint + "\" >&2; exit 1"), room);
        } catch (const Error& error) {
            return error.what();
        }
        return "none";
    };
    EXPECT_TRUE(contains(told("ModuleNotFoundError: No module named 'numpy'"),
                         "room.blend: Blender's Python lacks numpy"));
    EXPECT_TRUE(contains(told("Error: File format is not supported"), "room.blend: Blender cannot read it"));
    EXPECT_TRUE(
        contains(told("ModuleNotFoundError: No module named 'a b'"), "room.blend: Blender cannot read it"));
    // Blender's own add-ons miss some as it starts.
    const std::string own =
        "Traceback (most recent call last):\n  File 'bl_pkg/__init__.py', line 1, in register\n"
        "ModuleNotFoundError: No module named 'cattrs'\n";
    EXPECT_TRUE(contains(told(own), "Blender cannot read it"));
    EXPECT_TRUE(contains(told(own +
                              "Traceback (most recent call last):\n  File 'relume_link.py', line 18\n"
                              "ModuleNotFoundError: No module named 'numpy'\n" +
                              own),
                         "lacks numpy"));
}

} // namespace
} // namespace relume
