#pragma once

#include <string>
#include <vector>

#include "assets/base/warnings.h"
#include "assets/model/scene.h"
#include "assets/model/scene_edits.h"

// This header says how far and how bright a scene may be. All arithmetic behind it is in 32-bit floats, which
// end at 3.4e38; what is within these bounds leads to no infinity there.
namespace relume {

/// This is the largest coordinate, and the largest size of a light [m]: a hundred thousand kilometres. Form
/// factors and areas multiply four lengths with each other, and a length in such a scene, light and rays to
/// the sun included, is 7e8 m at most, which leaves a factor of a thousand. They are only right up to 1e9 m
/// (shaders/lib/form_factor.glsl); Embree aborts at rays that begin or end beyond 1.8e18 m.
constexpr float kFarthest = 1e8f;

/// This is the brightest channel of anything that shines, whatever its unit is ([cd], [lux], [cd/m^2]): a
/// thousand times the sun's disc. Bounces gather fifty times as much at most (albedo ends at 0.98), and
/// errors are sums of squares of it over all patches, of which a float holds those of 1e17.
constexpr float kBrightest = 1e12f;

/// These bound the factor of an instance on the texels per metre: beyond them it would have all of an atlas
/// or none of it.
constexpr float kLeastDensity = 0.01f, kMostDensity = 100.0f;

/// Tells whether no coordinate is beyond kFarthest (or not a number).
bool isWithinReach(const glm::vec3& point);
/// Tells whether no triangle of the mesh, placed with this transform, reaches beyond kFarthest.
bool isWithinReach(const Mesh& mesh, const glm::mat4& transform);

/// Drops triangles that reach beyond kFarthest where an instance stands, and instances of which nothing is
/// left. A mesh that another instance has whole is copied. There is one warning for each mesh.
void dropFarTriangles(Scene& scene, Warnings& warnings);
/// Returns what such a warning says of `count` triangles.
std::string farTriangles(size_t count);

/// Says, of a scene that lies so far from the origin that floats round its places to more than a few parts in
/// 100,000 of its size, what is wrong with it, as a sentence without its subject; "" of any other.
std::string coarsePlaces(const Scene& scene);

/// Brings a light, a material or the sky within the bounds. Returns what was wrong with it: for each thing
/// that was corrected, a sentence without its subject. A light may stand too far away for that: see
/// isWithinReach.
std::vector<std::string> limitLight(Light& light);
std::vector<std::string> limitMaterial(Material& material);
std::vector<std::string> limitSky(Sky& sky);

/// Brings edits within the bounds: what would stand too far away stays where it was. `before` are the edits
/// that these follow.
void limitEdits(const Scene& scene, const SceneEdits& before, SceneEdits& edits);

} // namespace relume
