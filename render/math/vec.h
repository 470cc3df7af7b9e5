// render/math/vec.h: vectors, frames and affine maps. float along a path, double while a scene is loaded and inside exact
// intersections.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace latent::render {

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

template <class T>
struct Vec2 {
    T x{}, y{};
    bool operator==(const Vec2&) const = default;
};

// Points, vectors and normals alike; the map that is applied to one says which it is.
template <class T>
struct Vec3 {
    T x{}, y{}, z{};

    Vec3() = default;
    constexpr Vec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
    template <class U>
    explicit constexpr Vec3(const Vec3<U>& v) : x(static_cast<T>(v.x)), y(static_cast<T>(v.y)), z(static_cast<T>(v.z)) {}

    bool operator==(const Vec3&) const = default;
    constexpr Vec3 operator-() const { return {-x, -y, -z}; }
    constexpr Vec3 operator+(const Vec3& b) const { return {x + b.x, y + b.y, z + b.z}; }
    constexpr Vec3 operator-(const Vec3& b) const { return {x - b.x, y - b.y, z - b.z}; }
    constexpr Vec3 operator*(T s) const { return {x * s, y * s, z * s}; }
    constexpr Vec3 operator/(T s) const { return {x / s, y / s, z / s}; }
    constexpr Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
    constexpr Vec3& operator*=(T s) { return *this = *this * s; }
    friend constexpr Vec3 operator*(T s, const Vec3& v) { return v * s; }
};

using Vec2f = Vec2<float>;
using Vec2d = Vec2<double>;
using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

template <class T>
constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
constexpr T abs_dot(const Vec3<T>& a, const Vec3<T>& b) {
    return std::abs(dot(a, b));
}
template <class T>
constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
constexpr T length_squared(const Vec3<T>& v) {
    return dot(v, v);
}
template <class T>
T length(const Vec3<T>& v) {
    return std::sqrt(dot(v, v));
}
template <class T>
Vec3<T> normalize(const Vec3<T>& v) {
    return v / length(v);
}
template <class T>
constexpr T max_abs(const Vec3<T>& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}
// 1 - cos of the angle between unit vectors, which keeps its digits where that is small.
template <class T>
constexpr T one_minus_dot(const Vec3<T>& a, const Vec3<T>& b) {
    return length_squared(a - b) / 2;
}
// `v`, turned into the hemisphere of `reference`.
template <class T>
constexpr Vec3<T> face_forward(const Vec3<T>& v, const Vec3<T>& reference) {
    return dot(v, reference) < T{0} ? -v : v;
}

// An orthonormal right-handed basis: local (0,0,1) is z.
struct Frame {
    Vec3f x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

    // Any frame about the unit vector `n`, without a branch [Duff17].
    static Frame from_z(const Vec3f& n) {
        const float sign = std::copysign(1.0f, n.z);
        const float a = -1 / (sign + n.z);
        const float b = n.x * n.y * a;
        return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
    }
    // The frame about unit `n` whose x lies as near `along` as it can; any frame if `along` is parallel to n or not finite.
    static Frame from_z_x(const Vec3f& n, const Vec3f& along) {
        const Vec3f x = along - n * dot(along, n);
        const float squared = length_squared(x);
        if (!(squared > 1e-6f * length_squared(along)) || !(squared < kInfinity)) return from_z(n);
        const Vec3f unit = normalize(x - n * dot(x, n));  // once more: the first difference may have cancelled
        return {unit, cross(n, unit), n};
    }
    Vec3f to_local(const Vec3f& v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
    Vec3f to_world(const Vec3f& v) const { return x * v.x + y * v.y + z * v.z; }
};

// p -> x p.x + y p.y + z p.z + t: the images of the three axes and of the origin.
template <class T>
struct Affine {
    Vec3<T> x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, t{0, 0, 0};

    Affine() = default;
    Affine(const Vec3<T>& x_, const Vec3<T>& y_, const Vec3<T>& z_, const Vec3<T>& t_) : x(x_), y(y_), z(z_), t(t_) {}
    template <class U>
    explicit Affine(const Affine<U>& a) : x(a.x), y(a.y), z(a.z), t(a.t) {}

    bool operator==(const Affine&) const = default;
    Vec3<T> point(const Vec3<T>& p) const { return x * p.x + y * p.y + z * p.z + t; }
    Vec3<T> vector(const Vec3<T>& v) const { return x * v.x + y * v.y + z * v.z; }
    // Normals go with the cofactors of the linear part, which is the inverse transpose times the determinant: the direction of
    // a surface that is mapped together with its normal, mirrored maps included. Not of unit length.
    Vec3<T> normal(const Vec3<T>& n) const {
        const Vec3<T> direction = cross(y, z) * n.x + cross(z, x) * n.y + cross(x, y) * n.z;
        return determinant() < 0 ? -direction : direction;
    }
    T determinant() const { return dot(x, cross(y, z)); }
    bool swaps_handedness() const { return determinant() < 0; }
    // First `b`, then this.
    Affine operator*(const Affine& b) const { return {vector(b.x), vector(b.y), vector(b.z), point(b.t)}; }
    // Nothing if the map is singular.
    std::optional<Affine> inverse() const {
        const T d = determinant();
        if (!(std::abs(d) > 0) || !std::isfinite(d)) return std::nullopt;
        const Vec3<T> a = cross(y, z) / d, b = cross(z, x) / d, c = cross(x, y) / d;  // rows of the inverse
        return Affine({a.x, b.x, c.x}, {a.y, b.y, c.y}, {a.z, b.z, c.z}, {-dot(a, t), -dot(b, t), -dot(c, t)});
    }
};

using Affinef = Affine<float>;
using Affined = Affine<double>;

}  // namespace latent::render
