#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/bench/quality/dark_views.h"
#include "app/edit/prepare.h"
#include "renderer/gl/headless_context.h"
#include "renderer/scene_renderer.h"

namespace relume {

/// The pictures of a scene by which bakes of it are compared. It must be destroyed before the Vulkan device.
class QualityPictures {
public:
    /// Opens OpenGL. Throws Error.
    explicit QualityPictures(const PreparedScene& prepared);

    /// Chooses three pictures and draws them with the reference, whose exposures hold from now on: by the
    /// cameras of the file, else by one that shows much; dark places make them three. Where `folder`
    /// is not "", it writes them there. Throws Error.
    void begin(const FloatImage& reference, const std::vector<LitPoint>& points, const std::string& folder);
    /// Draws the pictures with a lightmap. Returns the mean FLIP of each against the reference's. Writes them
    /// as well, as NAME-1.png and so on, where there are a folder and a name.
    std::vector<double> compare(const FloatImage& lightmap, const std::string& name);
    const std::vector<std::string>& names() const { return names_; } // what each shows

private:
    struct Shot {
        ViewCamera camera;
        float exposure = 0; // [EV]
        FloatImage reference;
    };
    FloatImage draw(const FloatImage& lightmap, const ViewCamera& camera, std::optional<float> exposure);
    void chooseCameras(const std::vector<LitPoint>& points);
    void write(const FloatImage& picture, const std::string& name, size_t index) const;

    const PreparedScene& prepared_;
    gl::HeadlessContext context_;
    SceneRenderer renderer_;
    SceneGpu scene_;
    gl::Framebuffer target_;
    std::string folder_;
    std::vector<Shot> shots_;
    std::vector<std::string> names_;
};

} // namespace relume
