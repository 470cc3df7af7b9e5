#include "render/geometry/tube.h"

namespace latent::render {

namespace {

// The axis at u.
struct Station {
    Vec3d p, tangent, d;
    double speed;

    Station(const CubicBezier& axis, double u) : p(point_on(axis, u)), tangent(tangent_at(axis, u)), speed(length(tangent)) {
        d = speed > 0 ? tangent / speed : Vec3d{0, 0, 1};
    }
};

// The u of the point of the axis whose cross-section `p` lies in: a step of Newton's method from nearby.
double section_of(const CubicBezier& axis, double u, const Vec3d& p) {
    const Station at(axis, u);
    const Vec3d away = p - at.p;
    const double slope = dot(at.tangent, at.tangent) - dot(away, bend_at(axis, u));
    return slope > 0 ? std::clamp(u + dot(away, at.tangent) / slope, 0.0, 1.0) : u;
}

}  // namespace

Tube tube_of(const MeshDescription& mesh, std::uint32_t segment) {
    const std::uint32_t first = mesh.indices[segment];
    const Vec3f* p = &mesh.positions[first];
    return {{Vec3d(p[0]), Vec3d(p[1]), Vec3d(p[2]), Vec3d(p[3])},
            static_cast<double>(mesh.radii[first]),
            static_cast<double>(mesh.radii[first + 3]),
            Vec3d(mesh.normals[segment])};
}

TubePoint::TubePoint(const Tube& tube, double near_u, const Vec3d& near) : u(section_of(tube.axis, near_u, near)) {
    const Station at(tube.axis, u);
    const double widens = tube.radius_1 - tube.radius_0, radius = tube.radius(u);
    d = at.d;
    const Vec3d away = near - at.p, out = away - d * dot(away, d);
    n = length_squared(out) > 0 ? normalize(out) : turned(tube.seam, Station(tube.axis, 0).d, d);
    p = at.p + n * radius;
    // The direction turns by `turn` per u. Where the tube is bent more than it is thick, its inside folds: no normal points
    // inwards.
    const Vec3d bend = bend_at(tube.axis, u), turn = at.speed > 0 ? (bend - d * dot(d, bend)) / at.speed : Vec3d{};
    const double stretch = std::max(at.speed - radius * dot(n, turn), 1e-6 * at.speed);
    const Vec3d around = cross(d, n) * (2 * std::numbers::pi);
    normal = at.speed > 0 ? n * stretch - d * widens : n;
    dpdu = d * stretch + n * widens;
    dpdv = around * radius;
    dndu = d * (-dot(n, turn) * stretch) - turn * widens;
    dndv = around * stretch;
}

double TubePoint::v(const Tube& tube) const {
    const Vec3d x = turned(tube.seam, Station(tube.axis, 0).d, d);
    return QuadricPart::angle_about_z({dot(n, x), dot(n, cross(d, x)), 0}) / (2 * std::numbers::pi);
}

// Each step takes the tube for the cone that touches it at u. Embree's bound on its error depends on the unit: where numbers are
// large, it takes points beside the tube for hits, from which no steps lead to a crossing.
std::optional<TubeCrossing> settle(const Tube& tube, const Vec3d& o, const Vec3d& d, double t, double u, double low, double high) {
    constexpr double kBeyond = 1e-4;  // the ends, in u: a hit is on one of two segments, for all that rounding does
    for (int i = 0; i < 12; ++i) {
        const Station at(tube.axis, u);
        if (!(at.speed > 0)) return std::nullopt;
        const double widens = (tube.radius_1 - tube.radius_0) / at.speed;
        const Vec3d from = o + d * t - at.p;  // counted from here: nothing cancels
        const double along = dot(from, at.d), speed = dot(d, at.d);
        const Vec3d away = from - at.d * along, across = d - at.d * speed;
        const double radius = tube.radius(u) + widens * along;
        // |away + s across| = radius + widens speed s: a s^2 + 2 b s + c = 0
        const double a = dot(across, across) - widens * widens * speed * speed, b = dot(away, across) - widens * speed * radius,
                     c = dot(away, away) - radius * radius, discriminant = b * b - a * c;
        if (!(discriminant >= 0)) return std::nullopt;
        // The root that is nearer to 0.
        const double q = b + std::copysign(std::sqrt(discriminant), b), step = q == 0 ? 0 : -c / q, axial = along + speed * step;
        t += step;
        const Vec3d bend = bend_at(tube.axis, u), turn = (bend - at.d * dot(at.d, bend)) / at.speed;
        u += axial / std::max(at.speed - dot(away + across * step, turn), 0.1 * at.speed);
        if (std::abs(axial) < 1e-6 * radius) {
            if (!(t > low && t < high && u > -kBeyond && u < 1 + kBeyond)) return std::nullopt;
            return TubeCrossing{t, std::clamp(u, 0.0, 1.0), b > 0};
        }
    }
    return std::nullopt;
}

}  // namespace latent::render
