#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/live/session.h"

namespace relume {

/// How a light shines, whatever it is: emission, lamp, sky or a group, of which nothing can be set.
struct LightPower {
    glm::vec3 color{1.0f};
    float intensity = 0.0f; // in lightUnitOf()
};
LightPower powerOf(const SceneEdits& edits, const LightKey& key);
/// Of an emitter: of its material, which others may share.
void setPower(SceneEdits& edits, const LightKey& key, const LightPower& power);
/// "emitter", "point", ..., "sky".
const char* lightTypeOf(const SceneEdits& edits, const LightKey& key);
const char* lightUnitOf(const SceneEdits& edits, const LightKey& key);

/// Emission as a colour of full brightness and a strength [cd/m^2].
struct EmissionParts {
    glm::vec3 colour{1.0f};
    float strength = 0;
};
EmissionParts splitEmission(const glm::vec3& emission);

/// Where a light is put that users add: what they look at.
struct LightSpot {
    glm::mat4 camera{1.0f};   // to world, looking along -Z
    glm::vec3 seen{0.0f};     // point in the middle of the picture [m]
    glm::vec3 lighting{0.0f}; // mean of the scene's surfaces, 0: dark [cd/m^2]
};
/// A light between the camera and what it looks at, shining there about as bright as the scene is.
Light makeLight(LightType type, const LightSpot& spot);
/// A sky as bright as the scene is.
SkySettings makeSky(SkySettings sky, const LightSpot& spot);

/// Behind the others; its key. A name that others have gets a number.
LightKey addLamp(Document& document, Light light);
/// A little beside the first one; its key.
LightKey duplicateLamp(Document& document, uint32_t index);
void eraseLamp(Document& document, uint32_t index);
/// Puts a light among the muted ones, or the solo ones, or takes it out.
void toggle(std::vector<LightKey>& keys, const LightKey& key);

/// Turn about +Y, then tilt about X, then roll about Z [degrees]: without tilt and turn a light shines along
/// -Z.
glm::vec3 lightAngles(const glm::mat4& transform);
/// The same place, turned so.
glm::mat4 withAngles(const glm::mat4& transform, const glm::vec3& degrees);
/// The same place, shining along `direction` [any length above 0].
glm::mat4 aimedAlong(const glm::mat4& transform, const glm::vec3& direction);

/// Sitting on a surface, `gap` [m] off it: beside its own extent; what shines to one side aims away from it.
glm::mat4 placedOn(const Light& light, const glm::vec3& position, const glm::vec3& normal, float gap);
/// Of the instance's triangle at a position, on the side of `towards`; unit. `towards` where there is none.
glm::vec3 normalAt(const WorldMesh& mesh, uint32_t instance, const glm::vec3& position,
                   const glm::vec3& towards);

/// The lights of an edited scene, looked up anew when the document changed.
class LightList {
public:
    /// nullptr: no lights. True: they may be others than before.
    bool update(const LoadedScene* scene, const Session& session);
    const std::vector<LightSource>& sources() const { return sources_; }
    /// nullptr: there is none of this key.
    const LightSource* find(const LightKey& key) const;
    /// How many instances shine by this material.
    size_t emittersOf(uint32_t material) const;

private:
    Scene scene_; // without geometry and pictures
    uint64_t number_ = 0, edits_ = 0;
    std::vector<LightSource> sources_;
};

} // namespace relume
