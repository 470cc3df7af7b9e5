#include "render/load/obj/polygon.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace latent::render {

namespace {

using Point = Vec2<double>;
constexpr std::size_t kMaxTests = 2'000'000'000;  // tests of corners in triangles: some seconds

// Twice the signed area of a triangle in the plane.
double area(const Point& a, const Point& b, const Point& c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

bool is_inside(const Point& p, const Point& a, const Point& b, const Point& c) {
    return area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0;
}

// Along the axis that its normal [Newell] is nearest to, so that it goes around counter-clockwise.
std::vector<Point> flattened(std::span<const Vec3d> corners) {
    Vec3d n;
    for (std::size_t i = 0; i < corners.size(); ++i)
        n += cross(corners[i] - corners[0], corners[(i + 1) % corners.size()] - corners[0]);
    std::vector<Point> flat;
    for (const Vec3d& p : corners) {
        if (std::abs(n.z) == max_abs(n)) {
            flat.push_back(n.z > 0 ? Point{p.x, p.y} : Point{p.y, p.x});
        } else if (std::abs(n.x) == max_abs(n)) {
            flat.push_back(n.x > 0 ? Point{p.y, p.z} : Point{p.z, p.y});
        } else {
            flat.push_back(n.y > 0 ? Point{p.z, p.x} : Point{p.x, p.z});
        }
    }
    return flat;
}

}  // namespace

bool triangulate(std::span<const Vec3d> corners, std::vector<std::uint32_t>& triangles) {
    const std::vector<Point> p = flattened(corners);
    std::vector<std::uint32_t> next(p.size()), previous(p.size());
    for (std::uint32_t i = 0; i < p.size(); ++i) {
        next[i] = static_cast<std::uint32_t>((i + 1) % p.size());
        previous[next[i]] = i;
    }
    const auto is_reflex = [&](std::uint32_t i) { return !(area(p[previous[i]], p[i], p[next[i]]) > 0); };
    // The corners that can lie in a triangle of others. Those that have gone, or are reflex no longer, do no harm.
    std::vector<std::uint32_t> reflex;
    for (std::uint32_t i = 0; i < p.size(); ++i) {
        if (is_reflex(i)) reflex.push_back(i);
    }
    std::vector<bool> gone(p.size());
    std::size_t tests = 0;
    const auto is_ear = [&](std::uint32_t b) {
        const std::uint32_t a = previous[b], c = next[b];
        tests += 1 + reflex.size();
        if (is_reflex(b)) return false;
        return std::ranges::none_of(reflex, [&](std::uint32_t other) {
            const bool is_corner = p[other] == p[a] || p[other] == p[b] || p[other] == p[c];
            return !gone[other] && !is_corner && is_inside(p[other], p[a], p[b], p[c]);
        });
    };
    std::uint32_t at = 1;
    for (std::size_t left = p.size(); left > 3; --left) {
        // Where a polygon crosses itself there may be no ear: then any corner goes.
        for (std::size_t tried = 0; tried < left && tests < kMaxTests && !is_ear(at); ++tried) at = next[at];
        if (tests >= kMaxTests) return false;
        triangles.insert(triangles.end(), {previous[at], at, next[at]});
        gone[at] = true;
        next[previous[at]] = next[at];
        previous[next[at]] = previous[at];
        at = next[at];
    }
    triangles.insert(triangles.end(), {previous[at], at, next[at]});
    return true;
}

}  // namespace latent::render
