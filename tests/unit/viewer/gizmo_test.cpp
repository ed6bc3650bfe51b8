#include "renderer/gizmo.h"
#include "renderer/light_outline.h"

#include <gtest/gtest.h>

#include <cmath>

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

ScreenView viewFrom(const glm::vec3& eye, const glm::vec3& target) {
    ScreenView view;
    view.camera.eye = eye;
    view.camera.target = target;
    view.size = {800.0f, 600.0f};
    return view;
}

GizmoPlace placeAt(const glm::vec3& origin, GizmoMode mode = GizmoMode::Translate) {
    return {viewFrom({4.0f, 3.0f, 7.0f}, {0.5f, 0.2f, 0.0f}), origin, mode};
}

glm::vec2 pointOf(const ScreenView& view, const glm::vec3& position) {
    return project(view, position).value();
}

glm::mat4 at(const glm::vec3& origin) {
    return glm::translate(glm::mat4(1.0f), origin);
}

TEST(ScreenSpace, APointLiesOnItsRay) {
    for (const float halfHeight : {0.0f, 3.0f}) {
        ScreenView view = viewFrom({1.0f, 2.0f, 5.0f}, {0.0f, 0.0f, -1.0f});
        view.camera.halfHeight = halfHeight;
        const glm::vec3 position(0.7f, -0.4f, 1.1f);
        const ScreenRay ray = rayThrough(view, pointOf(view, position));
        const float along = glm::dot(position - ray.origin, ray.direction);
        EXPECT_LT(glm::distance(ray.at(along), position), 1e-5f);
        EXPECT_LT(glm::distance(rayThrough(view, 0.5f * view.size).direction, forward(view.camera)), 1e-6f);
    }
}

TEST(ScreenSpace, AgreesWithTheRenderersMatrices) {
    for (const float halfHeight : {0.0f, 3.0f}) {
        ScreenView view = viewFrom({1.0f, 2.0f, 5.0f}, {0.0f, 0.0f, -1.0f});
        view.camera.halfHeight = halfHeight;
        const glm::vec3 position(0.7f, -0.4f, 1.1f);
        const float aspect = view.size.x / view.size.y;
        const glm::vec4 clip =
            projectionMatrix(view.camera, aspect) * viewMatrix(view.camera) * glm::vec4(position, 1.0f);
        const glm::vec2 share = 0.5f + 0.5f * glm::vec2(clip.x, -clip.y) / clip.w;
        EXPECT_LT(glm::distance(pointOf(view, position), share * view.size), 1e-2f);
    }
}

TEST(ScreenSpace, LinesBehindTheEyeAreCut) {
    const ScreenView view = viewFrom({0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, -1.0f});
    EXPECT_FALSE(project(view, {0.0f, 0.0f, 1.0f}));
    EXPECT_FALSE(projectLine(view, {0.0f, 0.0f, 1.0f}, {1.0f, 0.0f, 2.0f}));
    const auto line = projectLine(view, {0.0f, 0.0f, -2.0f}, {0.0f, 1.0f, 5.0f});
    ASSERT_TRUE(line);
    EXPECT_TRUE(std::isfinite(line->second.y));
    EXPECT_LT(line->second.y, 0.0f) << "upwards out of the picture";
}

// Under perspective, what is drawn under the cursor stays under it.
TEST(Gizmo, AnAxisMovesByTheWorldDistanceUnderTheCursor) {
    const glm::vec3 origin(0.3f, 0.4f, -0.6f);
    const GizmoPlace place = placeAt(origin);
    const struct {
        GizmoHandle handle;
        glm::vec3 axis;
    } cases[] = {{GizmoHandle::X, {1, 0, 0}}, {GizmoHandle::Y, {0, 1, 0}}, {GizmoHandle::Z, {0, 0, 1}}};
    for (const auto& [handle, axis] : cases) {
        for (const float way : {-1.5f, 0.01f, 2.0f}) {
            const glm::vec3 held = origin + 0.5f * axis;
            const GizmoDrag drag(place, handle, at(origin), pointOf(place.view, held));
            const glm::mat4 moved = drag.moved(pointOf(place.view, held + way * axis));
            EXPECT_LT(glm::distance(glm::vec3(moved[3]), origin + way * axis), 1e-3f) << way;
        }
    }
}

TEST(Gizmo, APlaneMovesInBothDirectionsAndNoOther) {
    const glm::vec3 origin(0.3f, 0.4f, -0.6f), way(0.7f, 0.0f, -0.9f);
    const GizmoPlace place = placeAt(origin);
    const GizmoDrag drag(place, GizmoHandle::ZX, at(origin), pointOf(place.view, origin));
    const glm::mat4 moved = drag.moved(pointOf(place.view, origin + way));
    EXPECT_LT(glm::distance(glm::vec3(moved[3]), origin + way), 1e-3f);
    EXPECT_EQ(moved[3].y, origin.y);
}

TEST(Gizmo, TheScreensPlaneKeepsTheDepth) {
    const glm::vec3 origin(0.3f, 0.4f, -0.6f);
    const GizmoPlace place = placeAt(origin);
    const GizmoDrag drag(place, GizmoHandle::Screen, at(origin), {400.0f, 300.0f});
    const glm::vec3 move = glm::vec3(drag.moved({450.0f, 260.0f})[3]) - origin;
    EXPECT_NEAR(glm::dot(move, forward(place.view.camera)), 0.0f, 1e-4f);
    const float length = lengthOnScreen(place.view, origin);
    EXPECT_NEAR(glm::dot(move, right(place.view.camera)), 50.0f * length, 1e-3f);
}

TEST(Gizmo, ARingTurnsByTheAngleUnderTheCursor) {
    const glm::vec3 origin(0.3f, 0.4f, -0.6f);
    const GizmoPlace place = placeAt(origin, GizmoMode::Rotate);
    const auto on = [&](float degrees) {
        const float angle = glm::radians(degrees);
        return pointOf(place.view, origin + glm::vec3(std::sin(angle), 0.0f, std::cos(angle)));
    };
    const glm::mat4 begin = glm::rotate(at(origin), 0.3f, {1, 0, 0});
    const GizmoDrag drag(place, GizmoHandle::Y, begin, on(20.0f));
    for (const float degrees : {-70.0f, 5.0f, 120.0f}) {
        const glm::mat4 moved = drag.moved(on(20.0f + degrees));
        const glm::mat4 turn = glm::rotate(glm::mat4(1.0f), glm::radians(degrees), {0, 1, 0});
        for (int column = 0; column < 3; ++column)
            EXPECT_LT(glm::distance(moved[column], turn * begin[column]), 1e-3f) << degrees;
        EXPECT_EQ(moved[3], begin[3]) << "it stays where it is";
    }
    const glm::mat4 stepped = drag.moved(on(20.0f + 50.0f), true);
    const glm::mat4 turn = glm::rotate(glm::mat4(1.0f), glm::radians(45.0f), {0, 1, 0});
    EXPECT_LT(glm::distance(stepped[0], turn * begin[0]), 1e-4f);
}

TEST(Gizmo, WhatStandsElsewhereIsTurnedAboutIt) {
    const glm::vec3 origin(0.3f, 0.4f, -0.6f), off(1.0f, 2.0f, 0.0f);
    const GizmoPlace place{viewFrom({0.0f, 0.0f, 5.0f}, glm::vec3(0.0f)), origin, GizmoMode::Rotate};
    const GizmoDrag drag(place, GizmoHandle::Screen, at(origin + off),
                         pointOf(place.view, origin + glm::vec3(1, 0, 0)));
    const glm::mat4 moved = drag.moved(pointOf(place.view, origin + glm::vec3(0, 1, 0)));
    EXPECT_LT(glm::distance(glm::vec3(moved[3]), origin + glm::vec3(-2.0f, 1.0f, 0.0f)), 1e-3f);
    EXPECT_LT(glm::distance(glm::vec3(moved[0]), glm::vec3(0, 1, 0)), 1e-3f);
}

// The front of a ring that is seen as a line goes along with the cursor.
TEST(Gizmo, ARingSeenFromItsEdgeTurnsByTheWayAlongIt) {
    const GizmoPlace place{viewFrom({0.0f, 0.0f, 5.0f}, glm::vec3(0.0f)), glm::vec3(0.0f), GizmoMode::Rotate};
    const GizmoDrag drag(place, GizmoHandle::Y, glm::mat4(1.0f), {400.0f, 300.0f});
    const glm::vec4 front = drag.moved({440.0f, 300.0f}) * glm::vec4(0.0f, 0.0f, 1.0f, 0.0f);
    EXPECT_GT(front.x, 0.3f) << "to the right, as the cursor";
    EXPECT_NEAR(glm::length(front), 1.0f, 1e-5f);
}

TEST(Gizmo, AViewAlongAnAxisIsSafe) {
    for (const glm::vec3 eye : {glm::vec3(6, 0, 0), glm::vec3(0, 6, 1e-4f), glm::vec3(0, 0, -6)}) {
        for (const GizmoMode mode : {GizmoMode::Translate, GizmoMode::Rotate}) {
            const GizmoPlace place{viewFrom(eye, glm::vec3(0.0f)), glm::vec3(0.0f), mode};
            for (int i = 1; i <= 7; ++i) {
                const GizmoDrag drag(place, static_cast<GizmoHandle>(i), glm::mat4(1.0f), {400.0f, 300.0f});
                for (const glm::vec2 point : {glm::vec2(400, 300), glm::vec2(430, 280), glm::vec2(0, 600)}) {
                    const glm::mat4 moved = drag.moved(point);
                    for (int column = 0; column < 4; ++column)
                        EXPECT_LT(glm::length(moved[column]), 10.0f) << i; // false of NaN too
                }
            }
        }
    }
    // Where the axis points at the eye, a drag downwards moves towards it.
    const GizmoPlace place{viewFrom({6, 0, 0}, glm::vec3(0.0f)), glm::vec3(0.0f), GizmoMode::Translate};
    const GizmoDrag drag(place, GizmoHandle::X, glm::mat4(1.0f), {400.0f, 300.0f});
    EXPECT_GT(drag.moved({400.0f, 340.0f})[3].x, 0.01f);
}

TEST(Gizmo, ADragTowardsTheVanishingPointStaysFinite) {
    const GizmoPlace place{
        viewFrom({0.0f, 1.0f, 5.0f}, {0.0f, 1.0f, 0.0f}), {0.0f, 0.0f, 0.0f}, GizmoMode::Translate};
    const GizmoDrag drag(place, GizmoHandle::Z, glm::mat4(1.0f), {400.0f, 420.0f});
    for (float y = 420.0f; y > 200.0f; y -= 1.0f)
        EXPECT_LE(glm::length(glm::vec3(drag.moved({400.0f, y})[3])), 1e4f) << y;
}

TEST(Gizmo, IsOfOneSizeAndHeldWhereItIsSeen) {
    for (const float distance : {2.0f, 50.0f}) {
        const GizmoPlace place{viewFrom({distance, 0.6f * distance, distance}, glm::vec3(0.0f)),
                               glm::vec3(0.0f), GizmoMode::Translate};
        const glm::vec3 tip = 80.0f * lengthOnScreen(place.view, place.origin) * glm::vec3(0, 1, 0);
        EXPECT_EQ(gizmoAt(place, pointOf(place.view, tip)), GizmoHandle::Y);
        EXPECT_EQ(gizmoAt(place, pointOf(place.view, glm::vec3(tip.y, 0, 0))), GizmoHandle::X);
        EXPECT_EQ(gizmoAt(place, pointOf(place.view, 0.42f * glm::vec3(tip.y, 0, tip.y))), GizmoHandle::ZX);
        EXPECT_EQ(gizmoAt(place, {400.0f, 300.0f}), GizmoHandle::Screen);
        EXPECT_EQ(gizmoAt(place, {20.0f, 20.0f}), GizmoHandle::None);
    }
    const GizmoPlace place{viewFrom({3, 2, 3}, glm::vec3(0.0f)), glm::vec3(0.0f), GizmoMode::Rotate};
    for (const GizmoShape& shape : gizmoShapes(place))
        EXPECT_EQ(gizmoAt(place, gripOf(shape)), shape.handle);
    const GizmoPlace behind{viewFrom(glm::vec3(0.0f), {0, 0, -1}), {0, 0, 3}, GizmoMode::Rotate};
    EXPECT_TRUE(gizmoShapes(behind).empty());
}

TEST(LightOutline, BodiesAreAsLargeAsTheyAre) {
    Light light;
    light.type = LightType::Rectangle;
    light.size = {3.0f, 0.5f};
    light.transform = at({1.0f, 2.0f, 3.0f});
    float most = 0;
    for (const OutlineSegment& segment : lightOutline(light, {.size = 0.01f}))
        most = std::max({most, std::abs(segment.from.x - 1.0f), std::abs(segment.to.x - 1.0f)});
    EXPECT_NEAR(most, 1.5f, 1e-5f);
    light.type = LightType::Spot;
    light.outerConeAngle = glm::half_pi<float>();
    for (const OutlineSegment& segment : lightOutline(light, {.size = 0.1f})) {
        EXPECT_LT(glm::distance(segment.from, glm::vec3(1, 2, 3)), 0.3f);
        EXPECT_LE(segment.from.z, 3.0f + 1e-5f) << "it shines along -Z";
    }
}

} // namespace
} // namespace relume
