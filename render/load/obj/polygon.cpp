#include "render/load/obj/polygon.h"

#include <cmath>
#include <numeric>

namespace latent::render {

namespace {

// Twice the signed area of a triangle in the plane.
double area(const Vec2<double>& a, const Vec2<double>& b, const Vec2<double>& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool is_inside(const Vec2<double>& p, const Vec2<double>& a, const Vec2<double>& b, const Vec2<double>& c) {
    return area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0;
}

// Along the axis that its normal [Newell] is nearest to, so that it goes around counter-clockwise.
std::vector<Vec2<double>> flattened(std::span<const Vec3d> corners) {
    Vec3d n;
    for (std::size_t i = 0; i < corners.size(); ++i)
        n += cross(corners[i] - corners[0], corners[(i + 1) % corners.size()] - corners[0]);
    std::vector<Vec2<double>> flat;
    for (const Vec3d& p : corners) {
        if (std::abs(n.z) == max_abs(n)) {
            flat.push_back(n.z > 0 ? Vec2<double>{p.x, p.y} : Vec2<double>{p.y, p.x});
        } else if (std::abs(n.x) == max_abs(n)) {
            flat.push_back(n.x > 0 ? Vec2<double>{p.y, p.z} : Vec2<double>{p.z, p.y});
        } else {
            flat.push_back(n.y > 0 ? Vec2<double>{p.z, p.x} : Vec2<double>{p.x, p.z});
        }
    }
    return flat;
}

}  // namespace

void triangulate(std::span<const Vec3d> corners, std::vector<std::uint32_t>& triangles) {
    const std::vector<Vec2<double>> p = flattened(corners);
    std::vector<std::uint32_t> left(corners.size());
    std::iota(left.begin(), left.end(), 0u);
    const auto is_ear = [&](std::size_t i) {
        const std::uint32_t a = left[(i + left.size() - 1) % left.size()], b = left[i], c = left[(i + 1) % left.size()];
        if (!(area(p[a], p[b], p[c]) > 0)) return false;
        for (const std::uint32_t other : left) {
            const bool is_corner = p[other] == p[a] || p[other] == p[b] || p[other] == p[c];
            if (!is_corner && is_inside(p[other], p[a], p[b], p[c])) return false;
        }
        return true;
    };
    std::size_t at = 1;
    while (left.size() > 3) {
        // Where a polygon crosses itself there may be no ear: then any corner goes.
        std::size_t tried = 0;
        while (tried < left.size() && !is_ear(at % left.size())) ++at, ++tried;
        const std::size_t i = at % left.size();
        triangles.insert(triangles.end(), {left[(i + left.size() - 1) % left.size()], left[i], left[(i + 1) % left.size()]});
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
        at = i;
    }
    triangles.insert(triangles.end(), {left[0], left[1], left[2]});
}

}  // namespace latent::render
