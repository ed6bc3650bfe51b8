#include "app/export/engine_files.h"

#include "app/export/engine_texts.h"
#include "assets/base/error.h"
#include "assets/images/float_image.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace relume {
namespace {

void replaceAll(std::string& text, const std::string& from, const std::string& to) {
    for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

// Keeps a name from being read as markup.
std::string inMarkup(std::string name) {
    replaceAll(name, "&", "&amp;");
    replaceAll(name, "<", "&lt;");
    return name;
}

// A camera of sensitivity S at EV100 shows light 1 / (1.2 x 2^EV100) times [Lagarde and de Rousiers 2014,
// equation 85], which is what Bevy does.
float ev100Of(float exposure) {
    return -exposure - std::log2(1.2f);
}

// Returns what a screen shows of light, in sRGB that goes on above white.
glm::dvec3 shownColour(const glm::vec3& light, float exposure) {
    glm::dvec3 colour = glm::dvec3(light) * std::exp2(double{exposure});
    for (int c = 0; c < 3; ++c)
        colour[c] = srgbFromLinear(colour[c]);
    return colour;
}

// Returns what stands between quotes for a name, in GDScript, C#, and Rust.
std::string inQuotedText(std::string name) {
    replaceAll(name, "\\", "\\\\");
    replaceAll(name, "\"", "\\\"");
    return name;
}

// Returns a text of which each line, its end included, is what change(line) gives.
template<typename Change>
std::string changeLines(const std::string& text, const Change& change) {
    std::string out;
    for (size_t begin = 0; begin < text.size();) {
        const size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
        out += change(text.substr(begin, end - begin));
        begin = end;
    }
    return out;
}

// Leaves out the lines that are for a lightmap of several pages, or those for one, and the marks of the
// others.
std::string forPages(const std::string& text, uint32_t pages) {
    const std::string own = pages > 1 ? "@MANY@" : "@ONE@", other = pages > 1 ? "@ONE@" : "@MANY@";
    return changeLines(text, [&](std::string line) {
        if (line.starts_with(own)) line.erase(0, own.size());
        return line.starts_with(other) ? std::string() : line;
    });
}

// Makes of each line that begins with a mark one for each material that the lightmap lights.
std::string forMaterials(const std::string& text, const std::vector<LitMaterial>& lit) {
    const std::string mark = "@EACH@";
    return changeLines(text, [&](const std::string& line) {
        if (!line.starts_with(mark)) return line;
        std::string lines;
        for (const LitMaterial& material : lit) {
            std::string own = line.substr(mark.size());
            replaceAll(own, "@PAGE@", std::to_string(material.page));
            replaceAll(own, "@MATERIAL@", inQuotedText(material.name));
            lines += own;
        }
        return lines;
    });
}

} // namespace

bool knowsPages(Engine engine) {
    return engine != Engine::Any; // whose light is in textures of another size
}

const std::vector<std::string>& engineNames() {
    static const std::vector<std::string> names = {"any",  "three", "babylon", "playcanvas",
                                                   "bevy", "godot", "unity",   "blender"};
    return names;
}

Engine engineOf(const std::string& name) {
    const auto& names = engineNames();
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
        throw Error(fmt::format("'{}' is no engine: use one of {}", name, fmt::join(names, ", ")));
    return static_cast<Engine>(found - names.begin());
}

std::vector<EngineFile> engineFiles(Engine engine, const EngineFacts& facts) {
    const std::string folder = engineNames()[static_cast<size_t>(engine)] + "/";
    std::vector<EngineFile> out;
    for (const EngineText& text : engineTexts()) {
        const std::string path = text.path;
        if (!path.starts_with(folder)) continue;
        EngineFile file{path.substr(folder.size()), forPages(text.text, facts.pages)};
        replaceAll(file.text, "@PAGES@", std::to_string(facts.pages));
        replaceAll(file.text, "@NAME@", file.name.ends_with(".html") ? inMarkup(facts.name) : facts.name);
        replaceAll(file.text, "@EV@", fmt::format("{:.4f}", facts.exposure));
        replaceAll(file.text, "@EV100@", fmt::format("{:.4f}", ev100Of(facts.exposure)));
        replaceAll(file.text, "@FACTOR@", fmt::format("{:.6g}", std::exp2(facts.exposure)));
        replaceAll(file.text, "@SKY@",
                   fmt::format("[{:.6g}, {:.6g}, {:.6g}]", facts.sky.r, facts.sky.g, facts.sky.b));
        const glm::dvec3 sky = shownColour(facts.sky, facts.exposure);
        replaceAll(file.text, "@SKY_COLOUR@", fmt::format("{:.6g}, {:.6g}, {:.6g}", sky.r, sky.g, sky.b));
        file.text = forMaterials(file.text, facts.lit);
        out.push_back(std::move(file));
    }
    return out;
}

} // namespace relume
