#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/live/session.h"

namespace relume {

/// How a light shines, be it a mesh light, an analytic light, the sky or a light group, of which nothing can
/// be set.
struct LightPower {
    glm::vec3 color{1.0f};
    float intensity = 0.0f; // in lightUnitOf()
};
LightPower powerOf(const SceneEdits& edits, const LightKey& key);
/// Sets how a light shines. A mesh light's power is that of its material, which others may share.
void setPower(SceneEdits& edits, const LightKey& key, const LightPower& power);
/// Returns "emitter", "point", ..., "sky".
const char* lightTypeOf(const SceneEdits& edits, const LightKey& key);
const char* lightUnitOf(const SceneEdits& edits, const LightKey& key);

/// Returns a colour as it may be typed: each channel from 0 to the brightest that there may be.
glm::vec3 typedColour(const glm::vec3& colour);
/// Returns an angle as it may be typed, without its whole turns [degrees]; 0 for one that is infinite.
float typedAngle(float degrees);
glm::vec3 typedAngles(const glm::vec3& degrees);

/// An emission as a colour of full brightness and a strength [cd/m^2].
struct EmissionParts {
    glm::vec3 colour{1.0f};
    float strength = 0;
};
EmissionParts splitEmission(const glm::vec3& emission);

/// The view of users, which decides where a light that they add is put.
struct LightSpot {
    glm::mat4 camera{1.0f};   // to world, looking along -Z
    glm::vec3 seen{0.0f};     // point in the middle of the picture [m]
    glm::vec3 lighting{0.0f}; // mean of the scene's surfaces, 0: dark [cd/m^2]
};
/// Returns a light between the camera and what it looks at, which shines there about as bright as the scene
/// is.
Light makeLight(LightType type, const LightSpot& spot);
/// Returns a sky that is as bright as the scene is.
SkySettings makeSky(SkySettings sky, const LightSpot& spot);

/// Adds a light behind the others and returns its key. A name that others have gets a number.
LightKey addLamp(Document& document, Light light);
/// Adds a copy a little beside the light, and returns its key.
LightKey duplicateLamp(Document& document, uint32_t index);
void eraseLamp(Document& document, uint32_t index);
/// Tells whether there is preview light, which a dark level got; with a key, whether this light is.
bool hasPreview(const SceneEdits& edits);
bool isPreview(const SceneEdits& edits, const LightKey& key);
/// Makes preview light the file's own, which a save writes. Its lights lose "Preview" from their names.
void keepPreview(SceneEdits& edits);
/// Puts a light among the muted ones, or the solo ones, or takes it out.
void toggle(std::vector<LightKey>& keys, const LightKey& key);

/// Returns the turn about +Y, then tilt about X, then roll about Z [degrees]: without tilt and turn a light
/// shines along -Z.
glm::vec3 lightAngles(const glm::mat4& transform);
/// Returns a transform with the same place, turned by these angles.
glm::mat4 withAngles(const glm::mat4& transform, const glm::vec3& degrees);
/// Returns a transform with the same place, which shines along `direction` [any length above 0].
glm::mat4 aimedAlong(const glm::mat4& transform, const glm::vec3& direction);

/// Returns the light's transform when it sits on a surface: it is `gap` [m] off, not counting its own extent,
/// and if it shines to one side it aims away from the surface.
glm::mat4 placedOn(const Light& light, const glm::vec3& position, const glm::vec3& normal, float gap);
/// Returns the unit normal of the instance's triangle at a position, on the side of `towards`, or `towards`
/// where the instance has no triangle.
glm::vec3 normalAt(const WorldMesh& mesh, uint32_t instance, const glm::vec3& position,
                   const glm::vec3& towards);

/// The lights of an edited scene, which are looked up anew when the document changed.
class LightList {
public:
    /// Follows the session's document. Returns whether the lights may be others than before; without a scene
    /// nothing changes.
    bool update(const LoadedScene* scene, const Session& session);
    const std::vector<LightSource>& sources() const { return sources_; }
    /// Returns the light of this key, or nullptr where there is none.
    const LightSource* find(const LightKey& key) const;
    /// Returns how many instances shine by this material.
    size_t emittersOf(uint32_t material) const;

private:
    Scene scene_; // without geometry and pictures
    uint64_t number_ = 0, edits_ = 0;
    std::vector<LightSource> sources_;
};

} // namespace relume
