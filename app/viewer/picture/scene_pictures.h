#pragma once

#include <cstdint>
#include <future>
#include <map>
#include <string>
#include <vector>

#include "renderer/gl/texture.h"

namespace relume {

/// Reads small pictures of scenes beside the main thread, for the start page. They belong to the current
/// OpenGL context.
class ScenePictures {
public:
    ~ScenePictures();
    /// Begins to read these files, once: a later call does nothing. One that is missing, or cannot be read,
    /// stays without a picture.
    void read(const std::vector<std::string>& files);
    bool reading() const { return read_.valid(); }
    /// Makes textures of what was read. Returns whether there are new ones.
    bool follow();
    /// Returns the texture of a file's picture; 0: there is none.
    uint32_t texture(const std::string& file) const;

private:
    struct Pixels {
        std::string file;
        uint32_t width = 0, height = 0;
        std::string bytes; // R, G and B of each pixel, the upper row first
    };
    static std::vector<Pixels> readAll(const std::vector<std::string>& files);

    bool begun_ = false;
    std::future<std::vector<Pixels>> read_;
    std::map<std::string, gl::Texture> textures_;
};

} // namespace relume
