#include "assets/gltf/gltf_camera.h"

#include <tiny_gltf.h>

namespace relume::gltf {

Camera makeCamera(const tinygltf::Camera& source, const std::string& name, const glm::mat4& transform) {
    Camera camera;
    camera.name = source.name.empty() ? name : source.name;
    camera.transform = transform;
    camera.perspective = source.type != "orthographic";
    if (camera.perspective) {
        camera.yfov = static_cast<float>(source.perspective.yfov);
        camera.aspect = static_cast<float>(source.perspective.aspectRatio);
        camera.znear = static_cast<float>(source.perspective.znear);
        camera.zfar = static_cast<float>(source.perspective.zfar);
    } else {
        camera.ymag = static_cast<float>(source.orthographic.ymag);
        if (source.orthographic.ymag != 0.0)
            camera.aspect = static_cast<float>(source.orthographic.xmag / source.orthographic.ymag);
        camera.znear = static_cast<float>(source.orthographic.znear);
        camera.zfar = static_cast<float>(source.orthographic.zfar);
    }
    return camera;
}

} // namespace relume::gltf
