#include "renderer/draw_settings.h"

namespace relume {

const std::vector<std::string>& viewNames() {
    static const std::vector<std::string> names = {"lit",      "lighting", "albedo",  "emission", "normal",
                                                   "material", "instance", "checker", "density",  "coverage"};
    return names;
}

const std::vector<std::string>& filterNames() {
    static const std::vector<std::string> names = {"nearest", "bilinear", "bicubic"};
    return names;
}

const std::vector<std::string>& toneNames() {
    static const std::vector<std::string> names = {"none", "aces", "agx"};
    return names;
}

bool showsLight(View view) {
    return view == View::Lit || view == View::Lighting || view == View::Emission ||
           view == View::InspectColor;
}

bool readsLightmap(View view) {
    return view == View::Lit || view == View::Lighting || view == View::Coverage ||
           view >= View::InspectColor;
}

} // namespace relume
