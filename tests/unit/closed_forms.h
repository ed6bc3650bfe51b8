#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

// These are view factors known in closed form, in double precision. The numbers (C-11 and so on) are those of
// [Howell, A Catalog of Radiation Heat Transfer Configuration Factors, 3rd ed.]. Lengths may be in any one
// unit.
namespace relume::closed {

inline constexpr double kPi = std::numbers::pi;

/// Returns C-11: between two equal, parallel, directly opposed rectangles of sides a and b at distance c.
inline double parallelRectangles(double a, double b, double c) {
    const double x = a / c, y = b / c, x1 = std::sqrt(1 + x * x), y1 = std::sqrt(1 + y * y);
    return 2 / (kPi * x * y) *
           (std::log(x1 * y1 / std::sqrt(1 + x * x + y * y)) + x * y1 * std::atan(x / y1) +
            y * x1 * std::atan(y / x1) - x * std::atan(x) - y * std::atan(y));
}

/// Returns C-14: from a rectangle of width w to one at a right angle to it of height h, both as long as their
/// common edge l.
inline double perpendicularRectangles(double w, double h, double l) {
    const double W = w / l, H = h / l, w2 = W * W, h2 = H * H, s = w2 + h2;
    const double a = (1 + w2) * (1 + h2) / (1 + s);
    const double b = w2 * (1 + s) / ((1 + w2) * s);
    const double c = h2 * (1 + s) / ((1 + h2) * s);
    return (W * std::atan(1 / W) + H * std::atan(1 / H) - std::sqrt(s) * std::atan(1 / std::sqrt(s)) +
            0.25 * (std::log(a) + w2 * std::log(b) + h2 * std::log(c))) /
           (kPi * W);
}

/// Returns C-41: from a disc of radius r1 to a parallel, coaxial one of radius r2 at distance h.
inline double coaxialDiscs(double r1, double r2, double h) {
    const double a = r1 / h, b = r2 / h, x = 1 + (1 + b * b) / (a * a);
    return 0.5 * (x - std::sqrt(x * x - 4 * (b / a) * (b / a)));
}

/// Returns B-12: from a small plate to a coaxial parallel disc of radius r at distance h.
inline double pointToDisc(double r, double h) {
    return r * r / (r * r + h * h);
}

/// Returns the same for a disc whose axis passes the plate at this distance; it is parallel to the plate
/// still.
inline double pointToParallelDisc(double away, double r, double h) {
    const double far2 = away * away + h * h, sum = far2 + r * r;
    return 0.5 * (1 - (far2 - r * r) / std::sqrt(sum * sum - 4 * away * away * r * r));
}

/// Returns B-3: from a small plate to a parallel rectangle a by b at distance c, one corner of which is on
/// the plate's normal.
inline double pointToParallelRectangle(double a, double b, double c) {
    const double x = a / c, y = b / c, x1 = std::sqrt(1 + x * x), y1 = std::sqrt(1 + y * y);
    return (x / x1 * std::atan(y / x1) + y / y1 * std::atan(x / y1)) / (2 * kPi);
}

/// Returns B-4: from a small plate to a rectangle at a right angle to it. The plate is at distance c from the
/// rectangle's plane, its normal is along the side a, and the corner nearest to it is at the foot of the
/// perpendicular; the other side is b.
inline double pointToPerpendicularRectangle(double a, double b, double c) {
    const double r = std::sqrt(a * a + c * c);
    return (std::atan(b / c) - c / r * std::atan(b / r)) / (2 * kPi);
}

/// Returns the factor in the integrating sphere: from any part of a sphere's inside to a part of that area,
/// it is that part's share of the whole area.
inline double sphereInterior(double area, double radius) {
    return area / (4 * kPi * radius * radius);
}

// These are vectors of the numeric reference.
using Vec = std::array<double, 3>;
inline Vec operator+(const Vec& a, const Vec& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vec operator-(const Vec& a, const Vec& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vec operator*(double s, const Vec& a) {
    return {s * a[0], s * a[1], s * a[2]};
}
inline double dot(const Vec& a, const Vec& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vec cross(const Vec& a, const Vec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Vec& a) {
    return std::sqrt(dot(a, a));
}
inline Vec unit(const Vec& a) {
    return 1 / length(a) * a;
}

/// Returns the view factor by adaptive integration, not by any formula for polygons: from point p of unit
/// normal n to the parallelogram corner + s u + t v, s and t in [0, 1], whose front is along u x v. Parts
/// below the horizon of n or seen from behind count as 0. The absolute error is about `tolerance`.
inline double integratedParallelogram(const Vec& p, const Vec& n, const Vec& corner, const Vec& u,
                                      const Vec& v, double tolerance = 1e-8) {
    const Vec front = cross(u, v);
    const auto gauss = [&](double s0, double t0, double h) { // 4 x 4 Gauss points on a square of side h
        constexpr double x[4] = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281,
                                 0.9305681557970263};
        constexpr double w[4] = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731,
                                 0.1739274225687269};
        double sum = 0;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) {
                const Vec d = corner + (s0 + h * x[i]) * u + (t0 + h * x[j]) * v - p;
                const double d2 = dot(d, d);
                sum +=
                    w[i] * w[j] * std::max(0.0, dot(n, d)) * std::max(0.0, -dot(front, d)) / (kPi * d2 * d2);
            }
        return sum * h * h;
    };
    // Cells that the horizon cuts are always divided: their sample points may all miss what is above it.
    const auto isCut = [&](double s0, double t0, double h) {
        int above = 0;
        for (int k = 0; k < 4; ++k)
            above += dot(n, corner + (s0 + (k & 1) * h) * u + (t0 + (k >> 1) * h) * v - p) > 0;
        return above % 4 != 0;
    };
    const auto refine = [&](const auto& self, double s, double t, double h, double whole,
                            double limit) -> double {
        const double k = h / 2;
        const double a = gauss(s, t, k), b = gauss(s + k, t, k), c = gauss(s, t + k, k),
                     d = gauss(s + k, t + k, k);
        const double sum = a + b + c + d;
        const bool fine = isCut(s, t, h) ? h < 1e-3 : h < 0.2 && std::abs(sum - whole) < limit;
        if (fine || h < 1e-4) return sum;
        return self(self, s, t, k, a, limit / 2) + self(self, s + k, t, k, b, limit / 2) +
               self(self, s, t + k, k, c, limit / 2) + self(self, s + k, t + k, k, d, limit / 2);
    };
    return refine(refine, 0, 0, 1, gauss(0, 0, 1), tolerance);
}

} // namespace relume::closed
