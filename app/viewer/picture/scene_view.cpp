#include "app/viewer/picture/scene_view.h"

#include "app/viewer/state/views.h"
#include "assets/base/error.h"
#include "assets/base/log.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_inverse.hpp>

namespace relume {
namespace {

constexpr uint64_t kNoMapVersion = ~uint64_t{0}; // of the lightmap before there is one: always the same
constexpr float kUvZoomStep = 1.2f;              // of one step of a wheel

} // namespace

SceneView::SceneView(const Session& session, LightmapExchange& exchange, Feedback& feedback, bool software)
    : session_(session), feedback_(feedback), pane_(software), bridge_(exchange) {}

bool SceneView::takeMap() {
    if (!bridge_.update()) return false;
    mapVersion_ = newVersion();
    if (state_.uv || viewEntries()[state_.view].readsMap) feedback_.pacer().newMap();
    return true;
}

const PublishedMap* SceneView::map() const {
    if (early_.pane) return nullptr;
    const PublishedMap* newest = bridge_.map();
    return newest != nullptr && newest->bake >= session_.firstBake() ? newest : nullptr;
}

ScenePane::Look SceneView::look() const {
    LightmapTexture lightmap{.size = mapSize(session_), .version = kNoMapVersion};
    if (map() != nullptr) {
        lightmap = bridge_.texture();
        lightmap.version = mapVersion_;
    }
    return {.camera = camera_.camera(), .state = state_, .lightmap = lightmap, .map = map()};
}

std::string SceneView::setScene(const LoadedScene& scene) {
    try {
        pane_.setScene(&scene);
    } catch (const Error& error) {
        const std::string why = scene.prepared.scene.path + ": cannot be drawn: " + error.what();
        spdlog::error("{}", why);
        return why;
    }
    return "";
}

bool SceneView::followEarly(const std::function<ViewCamera(const LoadedScene&)>& firstCamera) {
    const LoadedScene* early = session_.early();
    if (early == nullptr) {
        if (!early_.pane) return false;
        early_.pane.reset();
        const LoadedScene* scene = session_.scene();
        if (scene != nullptr && scene->number != early_.number)
            camera_.set(early_.former, scene->geometry.bounds);
        return true;
    }
    if (early_.pane && early_.number == early->number) return false;
    if (!early_.pane) early_.former = camera_.camera();
    early_.pane = std::make_unique<ScenePane>(pane_.software());
    try {
        early_.pane->setScene(early);
    } catch (const Error&) { // setScene() tells it of the whole scene
    }
    early_.number = early->number;
    const ViewCamera camera = firstCamera(*early);
    camera_.set(camera, early->geometry.bounds);
    return true;
}

void SceneView::place(const PictureArea& area, float scale, float pixels) {
    area_ = area;
    scale_ = scale;
    pixels_ = pixels;
}

std::optional<Pick> SceneView::pick(const glm::dvec2& at, std::optional<uint32_t> without) {
    if (early_.pane) return std::nullopt; // what is picked is the session's
    return pane_.pick(look(), (glm::vec2(at) - area_.corner) * pixels_, without);
}

LightSpot SceneView::lightSpot() {
    const ViewCamera& camera = camera_.camera();
    const glm::dvec2 middle = area_.corner + 0.5f * area_.size;
    const std::optional<Pick> seen = state_.uv ? std::nullopt : pick(middle);
    const PublishedMap* newest = map();
    const bool light = newest != nullptr && newest->content == MapContent::Light && !newest->radiance;
    return {.camera = glm::inverse(viewMatrix(camera)),
            .seen = seen ? seen->position : camera.target,
            .lighting = light ? newest->ambient : glm::vec3(0.0f)};
}

bool SceneView::showsLights() const {
    return session_.scene() != nullptr && !early_.pane && !state_.uv && !state_.bare;
}

bool SceneView::draw(bool anew, const glm::uvec2& window) {
    const auto toPixels = [&](float points) { return static_cast<uint32_t>(std::lround(points * pixels_)); };
    const glm::uvec2 corner(toPixels(area_.corner.x),
                            window.y - std::min(window.y, toPixels(area_.corner.y + area_.size.y)));
    const glm::uvec2 size =
        glm::max(glm::uvec2(toPixels(area_.size.x), toPixels(area_.size.y)), glm::uvec2(1));
    ScenePane& pane = shownPane();
    const bool resized = pane.picture().width() != size.x || pane.picture().height() != size.y;
    if (anew || resized) {
        pane.draw(look(), size);
        feedback_.sceneDrawn();
    }
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, static_cast<GLsizei>(window.x), static_cast<GLsizei>(window.y));
    glDisable(GL_SCISSOR_TEST);
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    pane.show(corner);
    return anew || resized;
}

void SceneView::drag(const glm::dvec2& way) {
    if (area_.size.y <= 0) return;
    if (state_.uv) {
        state_.uvWindow = pan(state_.uvWindow, glm::vec2(way), area_.size);
        feedback_.sceneChanged();
        return;
    }
    const glm::dvec2 share = way / static_cast<double>(area_.size.y);
    if (camera_.move(static_cast<float>(share.x), static_cast<float>(share.y))) cameraMoved();
}

void SceneView::zoom(float steps, const glm::dvec2& at) {
    if (state_.uv) {
        state_.uvWindow = relume::zoom(state_.uvWindow, std::pow(kUvZoomStep, steps),
                                       glm::vec2(at) - area_.corner, area_.size);
        feedback_.sceneChanged();
        return;
    }
    camera_.zoomBy(steps);
    cameraMoved();
}

void SceneView::fly(const CameraControl::Flight& flight, double time) {
    camera_.setFlight(flight);
    if (camera_.fly(time - flown_)) cameraMoved();
    flown_ = time;
    feedback_.pacer().animate(camera_.flying());
}

void SceneView::frameAll() {
    if (session_.scene() == nullptr) return;
    if (state_.uv)
        state_.uvWindow = {};
    else
        camera_.frame(session_.scene()->geometry.bounds, area_.aspect());
    cameraMoved();
}

void SceneView::seeFrom(const ViewCamera& camera) {
    camera_.set(camera);
    cameraMoved();
}

void SceneView::cameraMoved() {
    moved_ = feedback_.now();
    feedback_.sceneChanged();
}

} // namespace relume
