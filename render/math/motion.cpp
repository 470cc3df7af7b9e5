#include "render/math/motion.h"

namespace latent::render {

namespace {

template <class F>
Affined each_axis(const Affined& a, const Affined& b, F f) {
    return {f(a.x, b.x), f(a.y, b.y), f(a.z, b.z), {}};
}
Affined transposed(const Affined& a) { return {{a.x.x, a.y.x, a.z.x}, {a.x.y, a.y.y, a.z.y}, {a.x.z, a.y.z, a.z.z}, {}}; }
Affined linear_part(const Affined& a) { return {a.x, a.y, a.z, {}}; }
double size(const Affined& a) { return std::max({max_abs(a.x), max_abs(a.y), max_abs(a.z)}); }

}  // namespace

// Polar decomposition: the mean of a matrix and its inverse transpose, again and again, becomes its rotation [Shoemake92].
Motion::Parts Motion::parts_of(const Affined& map) {
    const Affined m = linear_part(map);
    Affined r = m;
    for (int i = 0; i < 100; ++i) {
        const Affined turned = transposed(r.inverse().value());
        const Affined next = each_axis(r, turned, [](const Vec3d& a, const Vec3d& b) { return (a + b) * 0.5; });
        const double change = size(each_axis(next, r, [](const Vec3d& a, const Vec3d& b) { return a - b; }));
        r = next;
        if (change < 1e-15) break;
    }
    if (r.swaps_handedness()) r = each_axis(r, r, [](const Vec3d& a, const Vec3d&) { return -a; });
    return {quaternion_of(r), transposed(r) * m};
}

// From the largest of its four numbers, which no cancellation has touched.
Motion::Quaternion Motion::quaternion_of(const Affined& r) {
    const double squares[4] = {1 + r.x.x + r.y.y + r.z.z, 1 + r.x.x - r.y.y - r.z.z, 1 - r.x.x + r.y.y - r.z.z,
                               1 - r.x.x - r.y.y + r.z.z};  // four times each
    const Vec3d minus(r.y.z - r.z.y, r.z.x - r.x.z, r.x.y - r.y.x), plus(r.y.z + r.z.y, r.z.x + r.x.z, r.x.y + r.y.x);
    switch (std::max_element(squares, squares + 4) - squares) {
        case 0:
            return {std::sqrt(squares[0]) / 2, minus / (2 * std::sqrt(squares[0]))};
        case 1: {
            const double x = std::sqrt(squares[1]);
            return {minus.x / (2 * x), Vec3d(x * x, plus.z, plus.y) / (2 * x)};
        }
        case 2: {
            const double y = std::sqrt(squares[2]);
            return {minus.y / (2 * y), Vec3d(plus.z, y * y, plus.x) / (2 * y)};
        }
        default: {
            const double z = std::sqrt(squares[3]);
            return {minus.z / (2 * z), Vec3d(plus.y, plus.x, z * z) / (2 * z)};
        }
    }
}

Affined Motion::rotation_of(const Quaternion& q) {
    const double square = q.w * q.w + dot(q.v, q.v);
    const auto image = [&](const Vec3d& p) { return p + (cross(q.v, p) * q.w + cross(q.v, cross(q.v, p))) * (2 / square); };
    return {image({1, 0, 0}), image({0, 1, 0}), image({0, 0, 1}), {}};
}

Motion::Motion(const Affined& start, const Affined& end, const Vec3d& center)
    : start_(start),
      end_(end),
      center_(center),
      from_(start.point(center)),
      to_(end.point(center)),
      first_(parts_of(start)),
      last_(parts_of(end)) {
    Quaternion &a = first_.rotation, &b = last_.rotation;
    if (a.w * b.w + dot(a.v, b.v) < 0) b = {-b.w, -b.v};
    const auto length_of = [](double w, const Vec3d& v) { return std::sqrt(w * w + dot(v, v)); };
    angle_ = 2 * std::atan2(length_of(b.w - a.w, b.v - a.v), length_of(b.w + a.w, b.v + a.v));
    if (linear_part(start) == linear_part(end)) angle_ = 0;
}

Affined Motion::at(double time) const {
    if (time <= 0) return start_;
    if (time >= 1) return end_;
    Affined map =
        each_axis(first_.stretch, last_.stretch, [&](const Vec3d& a, const Vec3d& b) { return a * (1 - time) + b * time; });
    const Quaternion &a = first_.rotation, &b = last_.rotation;
    // Shares of both ends. If the turn is small, sines are angles.
    const double share_a = angle_ > 1e-6 ? std::sin((1 - time) * angle_) : 1 - time,
                 share_b = angle_ > 1e-6 ? std::sin(time * angle_) : time;
    map = rotation_of({a.w * share_a + b.w * share_b, a.v * share_a + b.v * share_b}) * map;
    if (linear_part(start_) == linear_part(end_)) map = linear_part(start_);
    map.t = from_ * (1 - time) + to_ * time - map.vector(center_);
    return map;
}

// (R S q)'' = R'' S q + 2 R' S' q, as S'' = 0; R turns at the rate w = 2 angle, so |R' v| <= w |v| and |R'' v| <= w^2 |v|.
double Motion::bend(const Vec3d& p) const {
    const double w = 2 * angle_;
    const Vec3d q = p - center_, a = first_.stretch.vector(q), b = last_.stretch.vector(q);
    return w * w * std::max(length(a), length(b)) + 2 * w * length(b - a);
}

}  // namespace latent::render
