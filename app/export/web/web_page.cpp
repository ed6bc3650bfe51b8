#include "app/export/web/web_page.h"

#include "app/export/web/page_texts.h"
#include "app/export/web/web_light.h"
#include "app/export/web/web_scene.h"
#include "app/text/frame_names.h"
#include "assets/base/error.h"
#include "assets/base/file_write.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

namespace relume {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPage = "index.html";
constexpr const char* kStyle = "page.css";
constexpr const char* kData = "scene.js";
// They run in this order; each needs only those before it.
constexpr const char* kScripts[] = {"unpack.js", "shrink.js",   "maths.js", "mix.js",   "shaders.js",
                                    "draw.js",   "exposure.js", "move.js",  "board.js", "main.js"};

std::string textOf(const std::string& path) {
    for (const PageText& text : pageTexts())
        if (path == text.path) return text.text;
    ASSERT(false);
    return "";
}

void replaceAll(std::string& text, const std::string& from, const std::string& to) {
    size_t at = text.find(from);
    ASSERT(at != std::string::npos);
    for (; at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

std::string inMarkup(const std::string& name) {
    std::string out;
    for (const char letter : name)
        out += letter == '&' ? "&amp;" : letter == '<' ? "&lt;" : std::string(1, letter);
    return out;
}

// Returns a script of the page. The shaders get the functions that the program's own shaders have.
std::string scriptOf(const std::string& name) {
    std::string text = textOf(fmt::format("page/{}", name));
    if (name != "shaders.js") return text;
    for (const char* shared : {"lib/tone.glsl", "lib/scene_material.glsl", "lib/light/sky_place.glsl"})
        replaceAll(text, fmt::format("@{}@", shared), textOf(shared));
    return text;
}

// Returns the page, with what its parts are: names of files, or the parts themselves.
std::string pageOf(const std::string& name, const std::string& style, const std::string& scripts) {
    std::string page = textOf("page/index.html");
    replaceAll(page, "@NAME@", inMarkup(name));
    replaceAll(page, "@STYLE@", style);
    replaceAll(page, "@SCRIPTS@", scripts);
    return page;
}

std::string filesPage(const std::string& name) {
    std::string scripts;
    for (const char* script : kScripts)
        scripts += fmt::format("<script src=\"{}\"></script>\n", script);
    scripts += fmt::format("<script src=\"{}\"></script>", kData);
    return pageOf(name, fmt::format("<link rel=\"stylesheet\" href=\"{}\">", kStyle), scripts);
}

std::string wholePage(const std::string& name, const std::string& data) {
    std::string scripts;
    for (const char* script : kScripts)
        scripts += "<script>\n" + scriptOf(script) + "</script>\n";
    scripts += "<script>\n" + data + "</script>";
    return pageOf(name, "<style>\n" + textOf("page/page.css") + "</style>", scripts);
}

} // namespace

std::vector<std::string> framesIn(const std::string& folder) {
    std::vector<std::string> paths;
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
        if (isFrameName(at->path().filename().string())) paths.push_back(at->path().string());
    if (error) throw Error(folder + ": cannot be read: " + error.message());
    if (paths.empty()) throw Error(folder + ": holds no frames: give a folder that 'relume timelapse' wrote");
    std::sort(paths.begin(), paths.end(), [](const std::string& a, const std::string& b) {
        return std::pair(a.size(), a) < std::pair(b.size(), b); // frame_10000.png comes after frame_9999.png
    });
    return paths;
}

std::vector<std::string> webFiles(const WebDesc& desc) {
    if (desc.single) return {desc.path};
    std::vector<std::string> paths;
    const fs::path folder = desc.path;
    for (const char* name : {kPage, kStyle, kData})
        paths.push_back((folder / name).string());
    for (const char* name : kScripts)
        paths.push_back((folder / name).string());
    return paths;
}

void checkWebPage(const WebDesc& desc) {
    if (!desc.single && !checkFolderWritable(desc.path)) return;
    for (const std::string& path : webFiles(desc))
        checkFileWritable(path, 0);
}

void writeWebPage(const WebDesc& desc, const Scene& scene, const WorldMesh& mesh, const LayeredImage& image,
                  const std::string& name) {
    const std::string title = fs::path(scene.path).stem().string();
    WebContainer data;
    data.header["name"] = title;
    data.header["layers"] = fs::path(name).filename().string();
    data.header["exposure"] = desc.exposure ? nlohmann::json(*desc.exposure) : nlohmann::json();
    addLight(data, image, name);
    addScene(data, scene, mesh, image);
    addFrames(data, desc.frames);
    const std::string script = fmt::format("relume.start(\"{}\");\n", base64Of(data.packed()));
    if (desc.single) return writeFileAtomically(desc.path, wholePage(title, script), OnFailure::Drop);
    FolderForFiles place(desc.path);
    AtomicFiles files(OnFailure::Drop);
    const fs::path folder = desc.path;
    const auto write = [&](const char* file, const std::string& text) {
        files.add((folder / file).string(), text);
    };
    write(kData, script);
    for (const char* file : kScripts)
        write(file, scriptOf(file));
    write(kStyle, textOf("page/page.css"));
    write(kPage, filesPage(title));
    files.commit();
    place.keep();
}

} // namespace relume
