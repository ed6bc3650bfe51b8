#include "assets/atlas/chart_flatten.h"

#include "assets/base/numbering.h"

#define EIGEN_MPL2_ONLY // takes none of its files under other licences
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace relume {

namespace {

constexpr int kMostSteps = 12;    // of relaxation
constexpr double kSettled = 0.02; // share of the energy that a step must take away to be followed by another
constexpr double kIsometric = 1e-9;    // energy per area, below which nothing is left to relax
constexpr double kMostCotangent = 1e3; // bounds the weights of slivers, whose angles are noise

using Matrix = Eigen::SparseMatrix<double>;

/// Holds a triangle laid into a plane: edge k runs from corner k to the next.
struct RestShape {
    std::array<glm::dvec2, 3> edge;
    std::array<double, 3> weight; // half the cotangent of the angle across from the edge
};

RestShape restShapeOf(const glm::dvec3* p, const glm::dvec3& normal) {
    const glm::dvec3 side = p[1] - p[0];
    const double length = glm::length(side);
    const glm::dvec3 x = side / length, y = glm::cross(normal, x);
    const std::array<glm::dvec2, 3> q = {glm::dvec2(0.0), glm::dvec2(length, 0.0),
                                         glm::dvec2(glm::dot(p[2] - p[0], x), glm::dot(p[2] - p[0], y))};
    RestShape shape;
    for (size_t k = 0; k < 3; ++k)
        shape.edge[k] = q[(k + 1) % 3] - q[k];
    for (size_t k = 0; k < 3; ++k) {
        const glm::dvec2 a = -shape.edge[(k + 1) % 3], b = shape.edge[(k + 2) % 3]; // from the corner across
        const double sine = std::abs(a.x * b.y - a.y * b.x);
        const double cotangent = sine > 0.0 ? glm::dot(a, b) / sine : kMostCotangent;
        shape.weight[k] = 0.5 * std::clamp(cotangent, -kMostCotangent, kMostCotangent);
    }
    return shape;
}

/// Relaxes one patch: the matrix is made once, a step turns each triangle's rest shape and solves for the
/// vertices.
class Relaxation {
public:
    Relaxation(const WeldedMesh& mesh, const ChartPatch& patch) : patch_(patch) {
        shapes_.reserve(patch.triangles.size());
        for (uint32_t t : patch.triangles) {
            shapes_.push_back(restShapeOf(&mesh.corners[3 * size_t(t)], mesh.normal[t]));
            area_ += mesh.area[t];
        }
    }
    bool run(std::vector<glm::dvec2>& uv);

private:
    bool factorise();
    double turn(const std::vector<glm::dvec2>& uv);
    bool solve(std::vector<glm::dvec2>& uv);

    const ChartPatch& patch_;
    std::vector<RestShape> shapes_;
    double area_ = 0.0;
    Eigen::SimplicialLDLT<Matrix> solver_; // of all vertices but the first, which stays
    Eigen::MatrixX2d right_;
};

bool Relaxation::factorise() {
    const int size = static_cast<int>(patch_.vertices) - 1;
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(12 * shapes_.size());
    for (size_t t = 0; t < shapes_.size(); ++t) {
        for (size_t k = 0; k < 3; ++k) {
            const int a = static_cast<int>(patch_.vertex[3 * t + k]) - 1,
                      b = static_cast<int>(patch_.vertex[3 * t + (k + 1) % 3]) - 1;
            const double weight = shapes_[t].weight[k];
            if (a >= 0) entries.emplace_back(a, a, weight);
            if (b >= 0) entries.emplace_back(b, b, weight);
            if (a >= 0 && b >= 0)
                entries.emplace_back(std::max(a, b), std::min(a, b), -weight); // the lower half
        }
    }
    Matrix matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    solver_.compute(matrix);
    return solver_.info() == Eigen::Success;
}

/// Turns the rest shapes after the UVs and adds them to the right-hand side; returns the energy.
double Relaxation::turn(const std::vector<glm::dvec2>& uv) {
    right_.setZero(patch_.vertices - 1, 2);
    double energy = 0.0;
    for (size_t t = 0; t < shapes_.size(); ++t) {
        const RestShape& shape = shapes_[t];
        std::array<glm::dvec2, 3> edge;
        double cosine = 0.0, sine = 0.0;
        for (size_t k = 0; k < 3; ++k) {
            edge[k] = uv[patch_.vertex[3 * t + (k + 1) % 3]] - uv[patch_.vertex[3 * t + k]];
            const glm::dvec2& rest = shape.edge[k];
            cosine += shape.weight[k] * (rest.x * edge[k].x + rest.y * edge[k].y);
            sine += shape.weight[k] * (rest.x * edge[k].y - rest.y * edge[k].x);
        }
        const double length = std::sqrt(cosine * cosine + sine * sine);
        cosine = length > 0.0 ? cosine / length : 1.0;
        sine = length > 0.0 ? sine / length : 0.0;
        for (size_t k = 0; k < 3; ++k) {
            const glm::dvec2& rest = shape.edge[k];
            const glm::dvec2 turned(cosine * rest.x - sine * rest.y, sine * rest.x + cosine * rest.y);
            const glm::dvec2 off = edge[k] - turned;
            energy += shape.weight[k] * glm::dot(off, off);
            const int a = static_cast<int>(patch_.vertex[3 * t + k]) - 1,
                      b = static_cast<int>(patch_.vertex[3 * t + (k + 1) % 3]) - 1;
            for (int c = 0; c < 2; ++c) {
                if (a >= 0) right_(a, c) -= shape.weight[k] * turned[c];
                if (b >= 0) right_(b, c) += shape.weight[k] * turned[c];
            }
        }
    }
    return energy;
}

bool Relaxation::solve(std::vector<glm::dvec2>& uv) {
    const Eigen::MatrixX2d moved = solver_.solve(right_);
    if (solver_.info() != Eigen::Success || !moved.allFinite()) return false;
    uv[0] = glm::dvec2(0.0);
    for (uint32_t v = 1; v < patch_.vertices; ++v)
        uv[v] = {moved(v - 1, 0), moved(v - 1, 1)};
    return true;
}

bool Relaxation::run(std::vector<glm::dvec2>& uv) {
    if (patch_.vertices < 4 || !factorise()) return false;
    std::vector<glm::dvec2> now = uv;
    double before = turn(now);
    for (int step = 0; step < kMostSteps && before > kIsometric * area_; ++step) {
        if (!solve(now)) return false;
        const double energy = turn(now);
        const bool settled = energy > (1.0 - kSettled) * before;
        before = energy;
        if (settled) break;
    }
    uv = std::move(now);
    return true;
}

uint32_t cornerRoot(std::vector<uint32_t>& parent, uint32_t i) {
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

} // namespace

ChartPatch makePatch(const WeldedMesh& mesh, std::vector<uint32_t> triangles,
                     const std::vector<uint8_t>& glued, std::vector<uint32_t>& slot) {
    ChartPatch patch;
    patch.triangles = std::move(triangles);
    const uint32_t count = static_cast<uint32_t>(patch.triangles.size());
    for (uint32_t i = 0; i < count; ++i)
        slot[patch.triangles[i]] = i;
    std::vector<uint32_t> parent(3 * size_t(count));
    std::iota(parent.begin(), parent.end(), 0u);
    const auto join = [&](uint32_t a, uint32_t b) {
        const uint32_t rootA = cornerRoot(parent, a), rootB = cornerRoot(parent, b);
        parent[std::max(rootA, rootB)] = std::min(rootA, rootB);
    };
    for (uint32_t i = 0; i < count; ++i) {
        for (uint32_t k = 0; k < 3; ++k) {
            const uint32_t h = 3 * patch.triangles[i] + k, other = mesh.opposite[h];
            if (!glued[h] || other < h) continue;
            const uint32_t o = 3 * slot[other / 3];
            join(3 * i + k, o + WeldedMesh::nextCorner(other) % 3);
            join(3 * i + (k + 1) % 3, o + other % 3);
        }
    }
    patch.vertex.resize(parent.size());
    for (uint32_t i = 0; i < parent.size(); ++i) {
        const uint32_t root = cornerRoot(parent, i);
        patch.vertex[i] = root == i ? patch.vertices++ : patch.vertex[root];
    }
    return patch;
}

std::vector<glm::dvec2> projectAlong(const WeldedMesh& mesh, std::span<const uint32_t> triangles,
                                     const glm::dvec3& axis) {
    const glm::dvec3 helper = std::abs(axis.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(helper, axis)), v = glm::cross(axis, u);
    std::vector<glm::dvec2> uv;
    uv.reserve(3 * triangles.size());
    for (uint32_t t : triangles)
        for (size_t k = 0; k < 3; ++k) {
            const glm::dvec3& p = mesh.corners[3 * size_t(t) + k];
            uv.emplace_back(glm::dot(p, u), glm::dot(p, v));
        }
    return uv;
}

bool relaxPatch(const WeldedMesh& mesh, const ChartPatch& patch, std::vector<glm::dvec2>& uv) {
    return Relaxation(mesh, patch).run(uv);
}

} // namespace relume
