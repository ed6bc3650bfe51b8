#include "assets/gltf/gltf_sky_file.h"

#include "assets/base/error.h"
#include "assets/base/uri.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"

#include <filesystem>

namespace relume::gltf {

bool skyIsHomeless(const Sky& sky) {
    std::error_code code;
    return !sky.pixels.empty() && (sky.file.empty() || !std::filesystem::exists(sky.file, code));
}

std::string skyPathFrom(const Sky& sky, const std::string& path) {
    namespace fs = std::filesystem;
    std::string file;
    if (skyIsHomeless(sky)) {
        file = fs::path(path).stem().string() + "_sky.exr";
    } else if (!sky.file.empty()) {
        const fs::path folder = fs::path(path).parent_path();
        std::error_code code;
        const fs::path relative = fs::relative(sky.file, folder.empty() ? "." : folder, code);
        file = (code || relative.empty() ? fs::absolute(sky.file) : relative).generic_string();
    }
    if (!isUtf8(file))
        throw Error(path + ": the path of the sky's picture, '" + file +
                    "', is no UTF-8, as which glTF would hold it: rename it");
    return file;
}

void writeSkyPicture(const Sky& sky, const std::string& path) {
    FloatImage image{sky.width, sky.height, {}, {}, {}};
    for (int c = 0; c < 3; ++c) {
        std::vector<float>& plane = image.add(std::string(1, "RGB"[c]));
        for (size_t i = 0; i < plane.size(); ++i)
            plane[i] = sky.pixels[i][c];
    }
    writeImage(path, image);
}

} // namespace relume::gltf
