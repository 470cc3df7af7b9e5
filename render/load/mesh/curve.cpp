#include "render/load/mesh/curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace latent::render {

namespace {

constexpr std::uint32_t kSides = 16;

// Any direction across d.
Vec3d across(const Vec3d& d) {
    const Vec3d axis = std::abs(d.x) < std::abs(d.y) && std::abs(d.x) < std::abs(d.z) ? Vec3d(1, 0, 0)
                       : std::abs(d.y) < std::abs(d.z)                                ? Vec3d(0, 1, 0)
                                                                                      : Vec3d(0, 0, 1);
    return normalize(cross(d, axis));
}

// The same curve, to a thousandth of its length, with a direction at both ends: where the first or the last two points are one,
// Embree knows none.
CubicBezier with_directions(CubicBezier c) {
    const double size = 1e-6 * (length(c[1] - c[0]) + length(c[2] - c[1]) + length(c[3] - c[2]));
    if (!(length(c[1] - c[0]) > size)) c[1] = mix(c[0], length(c[2] - c[0]) > size ? c[2] : c[3], 1e-3);
    if (!(length(c[3] - c[2]) > size)) c[2] = mix(c[3], length(c[3] - c[1]) > size ? c[1] : c[0], 1e-3);
    return c;
}

// So many straight pieces that none is farther from the curve than a hundredth of its width: the distance is at most the greatest
// second derivative / (8 n^2).
std::uint32_t pieces_of(const CubicBezier& c, double width) {
    const double bend = 6 * std::max(length(c[0] - c[1] * 2 + c[2]), length(c[1] - c[2] * 2 + c[3]));
    const double n = std::ceil(std::sqrt(bend / (8 * 0.01 * std::max(width, 1e-30))));
    return static_cast<std::uint32_t>(std::clamp(n, 1.0, 64.0));
}

// A place on the curve, with its direction of unit length.
struct Ring {
    Vec3d p, d;
    double u, width;
    std::uint32_t segment;
    bool starts;  // a segment
};
std::vector<Ring> rings_of(const std::vector<CubicBezier>& segments, const CurveWidth& width) {
    std::vector<Ring> rings;
    const double count = static_cast<double>(segments.size());
    Vec3d last{0, 0, 1};
    for (std::uint32_t s = 0; s < segments.size(); ++s) {
        const std::uint32_t pieces = pieces_of(segments[s], std::min(width.w0, width.w1));
        for (std::uint32_t i = 0; i <= pieces; ++i) {
            const double u = static_cast<double>(i) / pieces, along = (s + u) / count;
            const Vec3d d = tangent_at(segments[s], u);
            if (length(d) > 0) last = normalize(d);  // else as before
            rings.push_back({point_on(segments[s], u), last, u, width.w0 + along * (width.w1 - width.w0), s, i == 0});
        }
    }
    return rings;
}

}  // namespace

std::vector<CubicBezier> segments_of(const std::vector<Vec3d>& p, std::uint32_t degree, bool is_bspline) {
    std::vector<CubicBezier> segments;
    const std::size_t step = is_bspline ? 1 : degree;
    if (p.size() <= degree || (p.size() - 1 - degree) % step != 0) return segments;
    for (std::size_t i = 0; i + degree < p.size(); i += step) {
        CubicBezier c;
        if (degree == 2) {
            const Vec3d begin = is_bspline ? mix(p[i], p[i + 1], 0.5) : p[i],
                        end = is_bspline ? mix(p[i + 1], p[i + 2], 0.5) : p[i + 2];
            c = {begin, mix(begin, p[i + 1], 2.0 / 3), mix(end, p[i + 1], 2.0 / 3), end};
        } else if (is_bspline) {
            const Vec3d near = mix(p[i + 1], p[i + 2], 1.0 / 3), far = mix(p[i + 1], p[i + 2], 2.0 / 3);
            c = {mix(mix(p[i], p[i + 1], 2.0 / 3), near, 0.5), near, far, mix(far, mix(p[i + 2], p[i + 3], 1.0 / 3), 0.5)};
        } else {
            c = {p[i], p[i + 1], p[i + 2], p[i + 3]};
        }
        segments.push_back(c);
    }
    return segments;
}

LoadedMesh tube_along(const std::vector<CubicBezier>& segments, const CurveWidth& width) {
    LoadedMesh tube;
    const double count = static_cast<double>(segments.size());
    Vec3d side, last;  // where v = 0, and the direction there
    for (std::size_t s = 0; s < segments.size(); ++s) {
        const CubicBezier axis = with_directions(segments[s]);
        const Vec3d begin = tangent_at(axis, 0), end = tangent_at(axis, 1);
        if (!(length(begin) > 0 && length(end) > 0)) continue;  // a single point
        const Vec3d d = normalize(begin);
        side = tube.indices.empty() ? across(d) : turned(side, last, d);
        const bool joins = !tube.positions.empty() && tube.positions.back() == axis[0];
        tube.indices.push_back(static_cast<std::uint32_t>(tube.positions.size() - (joins ? 1 : 0)));
        tube.normals.emplace_back(side);
        for (std::size_t i = joins ? 1 : 0; i < 4; ++i) {
            const double along = (static_cast<double>(s) + static_cast<double>(i) / 3) / count;
            tube.positions.push_back(axis[i]);
            tube.radii.push_back(0.5 * (width.w0 + along * (width.w1 - width.w0)));
        }
        last = normalize(end);
        side = turned(side, d, last);
    }
    return tube;
}

// The frame turns with the curve and not about it.
LoadedMesh tube_mesh(const std::vector<CubicBezier>& segments, const CurveWidth& width) {
    LoadedMesh mesh;
    const std::vector<Ring> rings = rings_of(segments, width);
    Vec3d x = rings.empty() ? Vec3d{} : across(rings.front().d);
    for (std::size_t i = 0; i < rings.size(); ++i) {
        const Ring& at = rings[i];
        if (i > 0) x = turned(x, rings[i - 1].d, at.d);
        const Vec3d y = cross(at.d, x);
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (std::uint32_t k = 0; k <= kSides; ++k) {  // the seam twice: v is 0 and 1 there
            const double v = static_cast<double>(k) / kSides, a = 2 * std::numbers::pi * v;
            const Vec3d n = x * std::cos(a) + y * std::sin(a);
            mesh.positions.push_back(at.p + n * (0.5 * at.width));
            mesh.normals.emplace_back(n);
            mesh.uvs.push_back({static_cast<float>(at.u), static_cast<float>(v)});
        }
        if (at.starts) continue;
        for (std::uint32_t k = 0; k < kSides; ++k) {
            const std::uint32_t a = first + k, b = a + 1, c = a - (kSides + 1), d = c + 1;  // a, b behind c, d
            mesh.indices.insert(mesh.indices.end(), {c, a, b, c, b, d});
        }
    }
    return mesh;
}

LoadedMesh ribbon_along(const std::vector<CubicBezier>& segments, const CurveWidth& width, const std::vector<Vec3d>& normals) {
    LoadedMesh mesh;
    for (const Ring& at : rings_of(segments, width)) {
        const Vec3d side = cross(mix(normals[at.segment], normals[at.segment + 1], at.u), at.d);
        const Vec3d half = (length(side) > 0 ? normalize(side) : across(at.d)) * (0.5 * at.width);
        const auto a = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(at.p - half);
        mesh.positions.push_back(at.p + half);
        mesh.uvs.push_back({static_cast<float>(at.u), 0});
        mesh.uvs.push_back({static_cast<float>(at.u), 1});
        if (!at.starts) mesh.indices.insert(mesh.indices.end(), {a - 2, a, a - 1, a + 1});
    }
    return mesh;
}

}  // namespace latent::render
