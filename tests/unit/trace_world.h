#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "bake/surface/trace_scene.h"

namespace relume {

/// Makes a scene for tracer tests of surfaces p(u, v), each a chart in its own cell of a 4 x 2 atlas of 64 x
/// 64 texels: 16 x 32 texels, so 8 chunks of patches each.
class TraceWorld {
public:
    using Surface = std::function<glm::vec3(float, float)>;
    static constexpr uint32_t kSize = 64, kCellWidth = 16, kCellHeight = 32;

    struct Look {
        bool doubleSided = false;
        bool receives = true;
        bool masked = false;
    };

    /// Adds a surface; cross(dp/du, dp/dv) points to the front. `cells` is the number of quads along u and
    /// along v.
    void add(const Surface& surface, uint32_t cells, const Look& look) {
        parts_.push_back({surface, cells, look});
    }
    void add(const Surface& surface, uint32_t cells) { add(surface, cells, Look{}); }
    /// Adds the inside of the box [lo, hi], as six charts.
    void addRoom(glm::vec3 lo, glm::vec3 hi, uint32_t cells) {
        for (int axis = 0; axis < 3; ++axis) {
            for (const bool high : {false, true}) {
                add(
                    [=](float u, float v) {
                        if (high) std::swap(u, v);
                        glm::vec3 p;
                        p[axis] = high ? hi[axis] : lo[axis];
                        p[(axis + 1) % 3] = glm::mix(lo[(axis + 1) % 3], hi[(axis + 1) % 3], u);
                        p[(axis + 2) % 3] = glm::mix(lo[(axis + 2) % 3], hi[(axis + 2) % 3], v);
                        return p;
                    },
                    cells);
            }
        }
    }
    void addBumpySphere(glm::vec3 centre, float radius, uint32_t cells) {
        add(
            [=](float u, float v) {
                const float phi = u < 1 ? -6.28318531f * u : 0.0f, theta = 3.14159265f * v;
                if (v <= 0 || v >= 1) return centre + glm::vec3(0, v <= 0 ? radius : -radius, 0);
                const float r =
                    radius * (1 + 0.1f * std::sin(7 * phi) * std::sin(theta) * std::sin(5 * theta));
                return centre + r * glm::vec3(std::sin(theta) * std::cos(phi), std::cos(theta),
                                              std::sin(theta) * std::sin(phi));
            },
            cells);
    }

    /// Builds the scene. Masked surfaces show a checker of 2 x 2 texels over each quad: solid where (u < 1/2)
    /// == (v < 1/2).
    TraceScene build() const {
        TraceScene scene;
        scene.size = kSize;
        scene.texelToPatch.assign(kSize * kSize, shader::kNoPatch);
        for (uint32_t chart = 0; chart < parts_.size(); ++chart)
            addPatches(scene, chart);
        for (const bool masked : {false, true}) {
            for (uint32_t chart = 0; chart < parts_.size(); ++chart)
                if (parts_[chart].look.masked == masked) addTriangles(scene, chart);
            if (!masked) scene.mesh.opaqueCount = scene.mesh.triangleCount();
        }
        scene.mesh.chartCount = uint32_t(parts_.size());
        scene.alphaMaterials = {{1.0f, 0.5f, 0, 2, 2, 0, 0}};
        scene.alphaTexels = {255, 0, 0, 255};
        return scene;
    }

private:
    struct Part {
        Surface surface;
        uint32_t cells;
        Look look;
    };

    static glm::vec2 atlas(uint32_t chart, float u, float v) {
        const float x = float(chart % 4 * kCellWidth) + u * float(kCellWidth);
        const float y = float(chart / 4 * kCellHeight) + v * float(kCellHeight);
        return glm::vec2(x, y) / float(kSize);
    }

    void addTriangles(TraceScene& scene, uint32_t chart) const {
        const Part& part = parts_[chart];
        const float step = 1.0f / float(part.cells);
        for (uint32_t k = 0; k < part.cells * part.cells; ++k) {
            const glm::vec2 lo = glm::vec2(k % part.cells, k / part.cells) * step, hi = lo + step;
            const glm::vec2 corners[4] = {lo, {hi.x, lo.y}, hi, {lo.x, hi.y}};
            addTriangle(scene, chart, corners[0], corners[1], corners[2]);
            addTriangle(scene, chart, corners[0], corners[2], corners[3]);
        }
    }

    void addTriangle(TraceScene& scene, uint32_t chart, glm::vec2 a, glm::vec2 b, glm::vec2 c) const {
        const Part& part = parts_[chart];
        const glm::vec3 p0 = at(part, a), p1 = at(part, b), p2 = at(part, c);
        const glm::vec3 normal = glm::cross(p1 - p0, p2 - p0);
        if (glm::length(normal) == 0) return;
        scene.mesh.positions.insert(scene.mesh.positions.end(), {p0, p1, p2});
        scene.mesh.material.push_back(0);
        scene.mesh.chart.push_back(part.look.receives ? chart : kNoChart);
        const glm::vec2 middle = (a + b + c) / 3.0f;
        const glm::vec2 texel = atlas(chart, middle.x, middle.y) * float(kSize);
        const uint32_t patch = scene.texelToPatch[uint32_t(texel.y) * kSize + uint32_t(texel.x)];
        scene.hitTriangles.push_back({atlas(chart, a.x, a.y), atlas(chart, b.x, b.y), atlas(chart, c.x, c.y),
                                      scene.mesh.chart.back(), part.look.receives ? patch : shader::kNoPatch,
                                      glm::normalize(normal), part.look.doubleSided ? 1u : 0u});
        if (!part.look.masked) return;
        const float n = float(part.cells);
        const glm::vec2 quad = glm::floor(middle * n);
        scene.alphaTriangles.push_back({a * n - quad, b * n - quad, c * n - quad, 1, 1, 1, 0});
    }

    // Patch centres lie on the triangles, not on the surface that these approximate.
    void addPatches(TraceScene& scene, uint32_t chart) const {
        const Part& part = parts_[chart];
        for (uint32_t k = 0; k < kCellWidth * kCellHeight; ++k) {
            const uint32_t x = k / 64 % (kCellWidth / 8) * 8 + k % 8,
                           y = k / 64 / (kCellWidth / 8) * 8 + k / 8 % 8;
            const glm::vec2 uv((float(x) + 0.5f) / float(kCellWidth), (float(y) + 0.5f) / float(kCellHeight));
            const uint32_t texel = (chart / 4 * kCellHeight + y) * kSize + chart % 4 * kCellWidth + x;
            shader::Patch patch = patchAt(part, uv);
            if (part.look.receives) patch.flags = shader::kPatchSends | texel << shader::kTexelShift;
            if (part.look.receives) scene.texelToPatch[texel] = uint32_t(scene.patches.size());
            scene.patches.push_back(patch);
            scene.patchChart.push_back(part.look.receives ? chart : kNoChart);
        }
    }

    static shader::Patch patchAt(const Part& part, glm::vec2 uv) {
        const float n = float(part.cells);
        const glm::vec2 cell = glm::min(glm::floor(uv * n), glm::vec2(n - 1)), in = uv * n - cell;
        const glm::vec3 p0 = at(part, cell / n), p2 = at(part, (cell + 1.0f) / n);
        const bool lower = in.x >= in.y;
        const glm::vec3 p1 = at(part, (cell + (lower ? glm::vec2(1, 0) : glm::vec2(0, 1))) / n);
        const float along = lower ? in.x : in.y, other = lower ? in.y : in.x;
        const glm::vec3 normal = lower ? glm::cross(p1 - p0, p2 - p0) : glm::cross(p2 - p0, p1 - p0);
        shader::Patch patch{};
        patch.position = p0 + (p1 - p0) * along + (p2 - p1) * other;
        const glm::vec3 size = glm::abs(patch.position);
        // A degenerate triangle (a sphere's pole) has no front: such a patch takes no part.
        const bool flat = glm::length(normal) > 0;
        patch.normal = patch.shading = flat ? glm::normalize(normal) : glm::vec3(0, 1, 0);
        patch.area = glm::length(normal) * n * n / float(kCellWidth * kCellHeight);
        patch.offset = 1e-4f * std::sqrt(patch.area) + 1e-6f * std::max({size.x, size.y, size.z});
        return patch;
    }

    static glm::vec3 at(const Part& part, glm::vec2 uv) { return part.surface(uv.x, uv.y); }

    std::vector<Part> parts_;
};

} // namespace relume
