#include "assets/gltf/gltf_camera_motion.h"

#include "assets/base/error.h"
#include "assets/gltf/gltf_animation.h"
#include "assets/gltf/gltf_camera.h"
#include "assets/gltf/gltf_check.h"
#include "assets/gltf/file/gltf_file.h"
#include "assets/gltf/gltf_node.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace relume {

namespace gltf {

namespace {

/// A camera's node, and what it is without a pose.
struct CameraNode {
    size_t node = 0;
    Camera camera;
};

std::vector<CameraNode> cameraNodes(const Build& build) {
    std::vector<CameraNode> out;
    for (size_t i = 0; i < build.nodes.size(); ++i)
        if (const auto camera = build.nodes[i].find("camera"); camera != build.nodes[i].end())
            out.push_back({i, makeCamera(build.model.cameras[camera->get<size_t>()],
                                         build.nodes[i].value("name", ""), glm::mat4(1.0f))});
    return out;
}

bool isMoved(const Build& build, size_t node, const Poses& poses) {
    const std::vector<int> parents = parentsOf(build.nodes);
    for (int i = static_cast<int>(node); i >= 0; i = parents[static_cast<size_t>(i)])
        if (poses.contains(static_cast<size_t>(i))) return true;
    return false;
}

// Returns the camera of this name, or without a name the first one that the poses move, else the first one.
CameraNode chosenCamera(const Build& build, const std::string& name, const Poses& poses) {
    const std::vector<CameraNode> all = cameraNodes(build);
    if (all.empty())
        throw Error(fmt::format("{}: has no camera that its animation could move: leave out --path animation",
                                build.path));
    const auto found = std::find_if(all.begin(), all.end(), [&](const CameraNode& c) {
        return name.empty() ? isMoved(build, c.node, poses) : c.camera.name == name;
    });
    if (found != all.end()) return *found;
    if (name.empty()) return all.front();
    std::string names;
    for (const CameraNode& c : all)
        names += (names.empty() ? "" : ", ") + inQuotes(c.camera.name);
    throw Error(fmt::format("{}: has no camera {}: it has {}", build.path, inQuotes(name), names));
}

bool isFinite(const glm::mat4& m) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            if (!std::isfinite(m[c][r])) return false;
    return true;
}

} // namespace

} // namespace gltf

CameraMotion readCameraMotion(const std::string& path, const GltfChoice& choice, const std::string& name,
                              double rate, uint32_t most) {
    gltf::Build build;
    build.path = path;
    build.choice = choice;
    gltf::File file = gltf::readFile(path);
    gltf::check(file);
    build.limit = gltf::checkSizes(file);
    gltf::parse(std::move(file), build);
    CameraMotion motion{.seconds = gltf::secondsOfAnimation(build), .cameras = {}};
    const gltf::CameraNode chosen = gltf::chosenCamera(build, name, gltf::posesOver(build, {0.0}).front());
    const double steps = std::max(1.0, std::round(motion.seconds * rate));
    if (steps >= most)
        throw Error(
            fmt::format("{}: its animation of {:.4g} s would take {:.0f} pictures, more than {}: lower --fps",
                        path, motion.seconds, steps + 1, most));
    std::vector<double> times;
    for (double i = 0; i <= steps; ++i)
        times.push_back(motion.seconds * i / steps);
    const std::vector<gltf::Poses> poses = gltf::posesOver(build, times);
    if (!gltf::isMoved(build, chosen.node, poses.front()))
        throw Error(
            fmt::format("{}: its first animation does not move camera {}: name another one by --camera, or "
                        "leave out --path animation",
                        path, inQuotes(chosen.camera.name)));
    for (const gltf::Poses& pose : poses) {
        gltf::NodePlaces places(build.nodes, pose);
        Camera camera = chosen.camera;
        camera.transform = glm::mat4(places.world(chosen.node));
        if (!gltf::isFinite(camera.transform))
            throw Error(fmt::format(
                "{}: its animation takes camera {} to places that are not finite: export it again", path,
                inQuotes(camera.name)));
        motion.cameras.push_back(std::move(camera));
    }
    return motion;
}

} // namespace relume
