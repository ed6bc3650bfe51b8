#include "assets/gltf/gltf_animation.h"

#include "assets/base/error.h"
#include "assets/base/warnings.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace relume::gltf {

namespace {

using nlohmann::json;
using Values = std::vector<float>;

enum class Interpolation { Step, Linear, CubicSpline };

/// Holds one channel's keys: `width` numbers per key, three times as many for splines.
struct Track {
    const Values& times;
    const Values& values;
    Interpolation interpolation;
    size_t width;
};

/// Reads the channels of an animation, which are not checked before: whatever does not fit gives a message.
class AnimationReader {
public:
    AnimationReader(Build& build, const json& animation) : build_(build), animation_(animation) {}
    Poses poses(double time);
    double end() const { return end_; } // [s], of the last key that was read

private:
    std::string apply(const json& channel, double time, Poses& poses);
    std::string setPath(const std::string& path, const json& sampler, double time, NodePose& pose);
    const Values& read(const json& sampler, const char* key, uint32_t components);

    Build& build_;
    const json& animation_;
    std::map<std::pair<size_t, uint32_t>, Values> known_; // by accessor and components
    double bytes_ = 0, end_ = 0;
};

const json* part(const json& holder, const char* key) {
    if (!holder.is_object()) return nullptr;
    const auto found = holder.find(key);
    return found == holder.end() ? nullptr : &*found;
}

/// Returns a member that is an index below `count`, or -1.
int64_t indexIn(const json& holder, const char* key, size_t count) {
    const json* value = part(holder, key);
    if (!value || !value->is_number_unsigned() || value->get<uint64_t>() >= count) return -1;
    return value->get<int64_t>();
}

std::string textOf(const json& holder, const char* key, const char* fallback) {
    const json* value = part(holder, key);
    return value && value->is_string() ? value->get<std::string>() : fallback;
}

/// Reads an accessor of a sampler; an empty list where it has none of so many components.
const Values& AnimationReader::read(const json& sampler, const char* key, uint32_t components) {
    static const Values none;
    const int64_t index = indexIn(sampler, key, build_.model.accessors.size());
    if (index < 0) return none;
    const tinygltf::Accessor& accessor = build_.model.accessors[static_cast<size_t>(index)];
    if (tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type)) !=
        static_cast<int32_t>(components))
        return none;
    const auto [place, isNew] = known_.try_emplace({static_cast<size_t>(index), components});
    if (isNew) {
        bytes_ += static_cast<double>(accessor.count) * components * sizeof(float);
        build_.limit.require(Made::Vertices, bytes_);
        place->second = readFloats(build_.model, accessor, components);
    }
    return place->second;
}

bool finiteAndSorted(const Values& times) {
    return std::all_of(times.begin(), times.end(), [](float t) { return std::isfinite(t); }) &&
           std::is_sorted(times.begin(), times.end());
}

/// Returns the numbers of a track at a time: those of a key, or between two of them (glTF 2.0, appendix C).
std::vector<double> valueAt(const Track& track, double time) {
    const bool spline = track.interpolation == Interpolation::CubicSpline;
    const size_t stride = track.width * (spline ? 3 : 1), middle = spline ? track.width : 0;
    const auto number = [&](size_t key, size_t i) { return double(track.values[key * stride + i]); };
    const auto after = std::upper_bound(track.times.begin(), track.times.end(), time,
                                        [](double t, float key) { return t < double(key); });
    const size_t next = static_cast<size_t>(after - track.times.begin()), key = next == 0 ? 0 : next - 1;
    std::vector<double> out(track.width);
    const bool between = next > 0 && next < track.times.size() && track.interpolation != Interpolation::Step;
    const double span = between ? double(track.times[next]) - double(track.times[key]) : 1.0;
    const double s = between ? (time - double(track.times[key])) / span : 0.0;
    for (size_t i = 0; i < track.width; ++i) {
        const double from = number(key, middle + i);
        if (!between) {
            out[i] = from;
            continue;
        }
        const double to = number(next, middle + i);
        if (!spline) {
            out[i] = from + s * (to - from);
            continue;
        }
        const double leaving = span * number(key, 2 * track.width + i), arriving = span * number(next, i);
        const double s2 = s * s, s3 = s2 * s;
        out[i] = (2 * s3 - 3 * s2 + 1) * from + (s3 - 2 * s2 + s) * leaving + (3 * s2 - 2 * s3) * to +
                 (s3 - s2) * arriving;
    }
    return out;
}

glm::dquat quaternionOf(const std::vector<double>& xyzw) {
    return {xyzw[3], xyzw[0], xyzw[1], xyzw[2]};
}

/// Returns a rotation at a time; linear means along the shortest great circle.
glm::dquat rotationAt(const Track& track, double time) {
    if (track.interpolation != Interpolation::Linear) return quaternionOf(valueAt(track, time));
    Track steps = track;
    steps.interpolation = Interpolation::Step;
    const auto after = std::upper_bound(track.times.begin(), track.times.end(), time,
                                        [](double t, float key) { return t < double(key); });
    const glm::dquat from = quaternionOf(valueAt(steps, time));
    if (after == track.times.begin() || after == track.times.end()) return from;
    const double begin = double(*(after - 1)), end = double(*after);
    const glm::dquat to = quaternionOf(valueAt(steps, end));
    if (!(glm::length(from) > 0.0) || !(glm::length(to) > 0.0)) return from;
    return glm::slerp(glm::normalize(from), glm::normalize(to), (time - begin) / (end - begin));
}

bool allFinite(const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

/// Sets what `path` names; returns what is wrong, "" for nothing.
std::string AnimationReader::setPath(const std::string& path, const json& sampler, double time,
                                     NodePose& pose) {
    const std::string name = textOf(sampler, "interpolation", "LINEAR");
    const Interpolation interpolation = name == "STEP"          ? Interpolation::Step
                                        : name == "CUBICSPLINE" ? Interpolation::CubicSpline
                                                                : Interpolation::Linear;
    const uint32_t components = path == "rotation" ? 4 : path == "weights" ? 1 : 3;
    const Values& times = read(sampler, "input", 1);
    const Values& values = read(sampler, "output", components);
    const size_t perKey = interpolation == Interpolation::CubicSpline ? 3 : 1;
    if (times.empty() || !finiteAndSorted(times)) return "has no keys in the order of time";
    if (values.empty() || values.size() % (times.size() * perKey) != 0)
        return "has not one value for each key";
    const size_t width = values.size() / (times.size() * perKey);
    if (path != "weights" && width != components) return "has not one value for each key";
    const Track track{times, values, interpolation, width};
    end_ = std::max(end_, double(times.back()));
    const std::vector<double> now = valueAt(track, time);
    if (!allFinite(now)) return "has values that are not finite (NaN)";
    if (path == "translation") pose.translation = glm::dvec3(now[0], now[1], now[2]);
    if (path == "scale") pose.scale = glm::dvec3(now[0], now[1], now[2]);
    if (path == "weights") pose.weights.assign(now.begin(), now.end());
    if (path == "rotation") pose.rotation = rotationAt(track, time);
    return "";
}

/// Applies one channel; returns what is wrong with it, "" for nothing.
std::string AnimationReader::apply(const json& channel, double time, Poses& poses) {
    const json* target = part(channel, "target");
    const json* samplers = part(animation_, "samplers");
    if (!target || !samplers || !samplers->is_array()) return "is damaged";
    const std::string path = textOf(*target, "path", "");
    if (path != "translation" && path != "rotation" && path != "scale" && path != "weights")
        return "moves something else than nodes and morph targets, which is left out";
    if (!part(*target, "node")) return ""; // of an extension, or of nothing: glTF says to pass over it
    const int64_t node = indexIn(*target, "node", build_.nodes.size());
    const int64_t sampler = indexIn(channel, "sampler", samplers->size());
    if (node < 0 || sampler < 0) return "is damaged";
    if (path != "weights" && build_.nodes[static_cast<size_t>(node)].contains("matrix"))
        return "moves a node that has a matrix, which glTF does not allow";
    const auto found = poses.try_emplace(static_cast<size_t>(node)).first;
    return setPath(path, (*samplers)[static_cast<size_t>(sampler)], time, found->second);
}

Poses AnimationReader::poses(double time) {
    Poses poses;
    const json* channels = part(animation_, "channels");
    if (!channels || !channels->is_array()) return poses;
    for (size_t i = 0; i < channels->size(); ++i) {
        std::string problem;
        try {
            problem = apply((*channels)[i], time, poses);
        } catch (const Error& error) { // of a sparse accessor
            problem = error.what();
        }
        if (!problem.empty()) build_.warnings.add(fmt::format("channel {} of the animation", i), problem);
    }
    return poses;
}

const json& firstAnimation(const Build& build, const char* mend) {
    if (build.animations.empty()) throw Error(fmt::format("{}: has no animation: {}", build.path, mend));
    return build.animations[0];
}

constexpr const char* kNoPath = "leave out --path animation";

} // namespace

double secondsOfAnimation(Build& build) {
    AnimationReader reader(build, firstAnimation(build, kNoPath));
    reader.poses(0.0);
    return reader.end();
}

std::vector<Poses> posesOver(Build& build, const std::vector<double>& times) {
    AnimationReader reader(build, firstAnimation(build, kNoPath));
    std::vector<Poses> out;
    for (const double time : times)
        out.push_back(reader.poses(time));
    return out;
}

Poses posesAt(Build& build, double time) {
    const json& animation = firstAnimation(build, "leave out --time");
    AnimationReader reader(build, animation);
    Poses poses = reader.poses(time);
    const std::string name = textOf(animation, "name", "");
    const std::string label = name.empty() ? "its first animation" : "animation " + inQuotes(name);
    build.warnings.add(label, time > reader.end()
                                  ? fmt::format("ends at {:.4g} s, and is shown as it is then", reader.end())
                                  : fmt::format("is shown as it is at {:.4g} s", time));
    return poses;
}

} // namespace relume::gltf
