#include "app/viewer/state/views.h"

#include <string_view>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace relume {
namespace {

constexpr int kWithShift = GLFW_MOD_SHIFT;

ViewEntry ofScene(const char* name, const char* title, const char* tells, View view, int key, int mods = 0) {
    const bool reads = readsLightmap(view);
    return {.name = name,
            .title = title,
            .tells = tells,
            .view = view,
            .readsMap = reads,
            .key = key,
            .mods = mods};
}

ViewEntry ofMap(const char* name, const char* title, const char* tells, MapContent content, View view,
                int key, int mods = 0) {
    return {.name = name,
            .title = title,
            .tells = tells,
            .view = view,
            .readsMap = true,
            .content = content,
            .key = key,
            .mods = mods};
}

std::vector<ViewEntry> makeEntries() {
    return {
        ofScene("lit", "Lit", "albedo times lightmap, and emission", View::Lit, GLFW_KEY_1),
        ofScene("lighting", "Lighting", "the lightmap alone", View::Lighting, GLFW_KEY_2),
        ofScene("albedo", "Albedo", "what surfaces reflect", View::Albedo, GLFW_KEY_3),
        ofMap("pos", "pos", "positions of the patches", MapContent::Position, View::InspectPosition,
              GLFW_KEY_4),
        ofMap("nrm", "nrm", "normals of the patches", MapContent::Normal, View::InspectNormal, GLFW_KEY_5),
        ofMap("mat", "mat", "albedo of the patches", MapContent::Material, View::InspectRaw, GLFW_KEY_6),
        ofMap("arf", "arf", "area of the patches", MapContent::Area, View::InspectHeat, GLFW_KEY_7),
        ofMap("ligIn", "ligIn", "light that the pass reads", MapContent::LigIn, View::InspectColor,
              GLFW_KEY_8),
        ofMap("ligOut", "ligOut", "light that the pass has gathered", MapContent::LigOut, View::InspectColor,
              GLFW_KEY_9),
        ofMap("error", "Error",
              "how far each texel may still be off, relative to its own light; click one to read it",
              MapContent::Error, View::InspectHeat, GLFW_KEY_0),
        ofMap("layer", "Light alone", "the selected light and nothing else", MapContent::Layer, View::Lit,
              GLFW_KEY_L, GLFW_MOD_ALT),
        ofMap("leaves", "Quad-tree", "leaves of the adaptive method", MapContent::Leaves, View::InspectLeaves,
              GLFW_KEY_1, kWithShift),
        ofMap("seen", "Visible from here", "patches that the clicked one sees, and its links",
              MapContent::Seen, View::InspectMask, GLFW_KEY_2, kWithShift),
        {.name = "voxels",
         .title = "Voxels",
         .tells = "what marching through voxels meets",
         .view = View::Lit,
         .voxels = true,
         .key = GLFW_KEY_3,
         .mods = kWithShift},
        ofScene("checker", "Patch checker", "the lightmap's texels", View::Checker, GLFW_KEY_4, kWithShift),
        ofScene("density", "Texel density", "texels per metre", View::Density, GLFW_KEY_5, kWithShift),
        ofScene("coverage", "Coverage", "patches, filled and empty texels", View::Coverage, GLFW_KEY_6,
                kWithShift),
        ofScene("emission", "Emission", "what surfaces emit", View::Emission, GLFW_KEY_7, kWithShift),
        ofScene("normal", "Normals", "shading normals of the model", View::Normal, GLFW_KEY_8, kWithShift),
        ofScene("material", "Materials", "a colour for each", View::Material, GLFW_KEY_9, kWithShift),
        ofScene("instance", "Instances", "a colour for each", View::Instance, GLFW_KEY_0, kWithShift),
    };
}

} // namespace

const std::vector<ViewEntry>& viewEntries() {
    static const std::vector<ViewEntry> entries = makeEntries();
    return entries;
}

size_t viewIndex(const char* name) {
    const std::vector<ViewEntry>& entries = viewEntries();
    for (size_t i = 0; i < entries.size(); ++i)
        if (std::string_view(entries[i].name) == name) return i;
    return 0;
}

bool hasMips(MapContent content) {
    return content == MapContent::LigIn || content == MapContent::LigOut;
}

} // namespace relume
