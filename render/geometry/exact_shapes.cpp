#include "render/geometry/exact_shapes.h"

namespace latent::render {

namespace {

// The real roots of a t^2 + b t + c, smaller first, without cancellation; a line has one root, returned twice.
std::optional<std::array<double, 2>> roots(double a, double b, double c) {
    if (a == 0) {
        if (b == 0) return std::nullopt;
        return std::array{-c / b, -c / b};
    }
    const double discriminant = b * b - 4 * a * c;
    if (!(discriminant >= 0)) return std::nullopt;
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    double t0 = q / a, t1 = q == 0 ? t0 : c / q;
    if (t0 > t1) std::swap(t0, t1);
    return std::array{t0, t1};
}

// The first root of |o + t d| = radius between low and high whose point is accepted.
template <class Accept>
std::optional<ExactHit> first_on_sphere(const Vec3d& o, const Vec3d& d, double radius, double low, double high,
                                        const Accept& accept) {
    const double a = dot(d, d), b = dot(o, d);
    // The discriminant from the distance of the ray's line to the centre: exact where b^2 - a c would cancel.
    const Vec3d closest = o - d * (b / a);
    const double distance = length(closest), inside = (radius - distance) * (radius + distance);
    if (!(inside >= 0)) return std::nullopt;
    const double q = -(b + std::copysign(std::sqrt(a * inside), b));
    const double size = length(o), c = (size - radius) * (size + radius);
    double t0 = q / a, t1 = q == 0 ? t0 : c / q;
    if (t0 > t1) std::swap(t0, t1);
    for (const double t : {t0, t1}) {
        if (t > low && t < high && accept(t)) return ExactHit{t};
    }
    return std::nullopt;
}

}  // namespace

std::optional<ExactHit> intersect_sphere(const Vec3d& o, const Vec3d& d, double radius, const QuadricPart& part, double low,
                                         double high) {
    return first_on_sphere(o, d, radius, low, high, [&](double t) { return part.holds(o + d * t); });
}

std::optional<ExactHit> intersect_cylinder(const Vec3d& o, const Vec3d& d, double radius, const QuadricPart& part, double low,
                                           double high) {
    if (d.x == 0 && d.y == 0) return std::nullopt;
    return first_on_sphere({o.x, o.y, 0}, {d.x, d.y, 0}, radius, low, high, [&](double t) { return part.holds(o + d * t); });
}

std::optional<ExactHit> intersect_disk(const Vec3d& o, const Vec3d& d, double height, double inner, double radius,
                                       const QuadricPart& part, double low, double high) {
    if (d.z == 0) return std::nullopt;
    const double t = (height - o.z) / d.z;
    if (!(t > low && t < high)) return std::nullopt;
    const double x = o.x + t * d.x, y = o.y + t * d.y, squared = x * x + y * y;
    if (squared > radius * radius || squared < inner * inner || !part.holds({x, y, height})) return std::nullopt;
    return ExactHit{t};
}

std::optional<ExactHit> intersect_patch(const Vec3d& o, const Vec3d& d, const PatchCorners& p, double low, double high) {
    const double a = dot(cross(p[1] - p[0], p[2] - p[3]), d);
    const double c = dot(cross(p[0] - o, d), p[2] - p[0]);
    const double b = dot(cross(p[1] - o, d), p[3] - p[1]) - (a + c);
    const auto u_roots = roots(a, b, c);
    if (!u_roots) return std::nullopt;
    std::optional<ExactHit> nearest;
    for (const double u : *u_roots) {
        if (!(u >= 0 && u <= 1)) continue;
        // The straight line of constant u: origin + v along.
        const Vec3d origin = p[0] * (1 - u) + p[1] * u, along = p[2] * (1 - u) + p[3] * u - origin, to = origin - o;
        const Vec3d normal = cross(d, along);
        const double squared = dot(normal, normal);
        const double v = dot(to, cross(d, normal)) / squared, t = dot(to, cross(along, normal)) / squared;
        if (!(v >= 0 && v <= 1) || !(t > low && t < high)) continue;
        if (!nearest || t < nearest->t) nearest = ExactHit{t, u, v};
    }
    return nearest;
}

}  // namespace latent::render
