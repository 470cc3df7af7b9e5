#include "render/camera/camera.h"

#include "render/math/equal_area.h"
#include "render/sampling/warp.h"
#include "render/scene/check.h"

namespace latent::render {

namespace {

Affinef unit(const Affined& m) {
    const double scale = length(m.x);
    return Affinef(Affined(m.x / scale, m.y / scale, m.z / scale, m.t));
}

}  // namespace

Result<Camera> Camera::make(const CameraDescription& d) {
    if (const Refusals r = check_camera(d); !r.empty()) return Error{ErrorCode::kUnsupported, r.front()};
    const double scale = length(d.world_from_camera.x);
    Camera c;
    c.kind_ = d.kind;
    c.mapping_ = d.mapping;
    c.world_ = unit(d.world_from_camera);
    const double window = d.kind == CameraKind::kOrthographic ? scale : 1;
    c.x0_ = static_cast<float>(d.x0 * window);
    c.x1_ = static_cast<float>(d.x1 * window);
    c.y0_ = static_cast<float>(d.y0 * window);
    c.y1_ = static_cast<float>(d.y1 * window);
    c.window_area_ = (c.x1_ - c.x0_) * (c.y1_ - c.y0_);
    c.lens_radius_ = static_cast<float>(d.lens_radius * scale);
    c.focal_distance_ = static_cast<float>(d.focal_distance * scale);
    c.focal_slope_ = d.focal_slope * scale;
    if (c.splits_wavelengths()) {
        const auto most = static_cast<float>(std::max(std::abs(c.defocus(360)), std::abs(c.defocus(830)))) * 1.001f;
        c.margin_ = {c.lens_radius_ / (c.x1_ - c.x0_) * most, c.lens_radius_ / (c.y1_ - c.y0_) * most};
    }
    c.medium_ = d.medium;
    return c;
}

Camera Camera::moved_to(const Affined& world_from_camera) const {
    Camera c = *this;
    c.world_ = unit(world_from_camera);
    return c;
}

Vec2f Camera::lens_point(float s, float t) const { return has_lens() ? sample_disk(s, t) : Vec2f{0, 0}; }

void Camera::ray(double u, double v, const Vec2f& lens, Vec3f& origin, Vec3f& direction) const {
    const float x = static_cast<float>(x0_ + u * (x1_ - x0_)), y = static_cast<float>(y1_ + v * (y0_ - y1_));
    Vec3f o = on_lens(lens), d;
    switch (kind_) {
        case CameraKind::kPerspective:
            d = {x - o.x / focal_distance_, y - o.y / focal_distance_, 1};  // towards the point in focus, over its distance
            break;
        case CameraKind::kOrthographic:
            o = {x, y, 0};
            d = {0, 0, 1};
            break;
        case CameraKind::kSpherical:
            if (mapping_ == SphericalMapping::kEqualArea) {
                d = sphere_from_square({static_cast<float>(u), static_cast<float>(v)});
            } else {
                const SinCos theta = sincos_turns(static_cast<float>(v * 0.5)), phi = sincos_turns(static_cast<float>(u));
                d = {theta.sin * phi.cos, theta.sin * phi.sin, theta.cos};
            }
            std::swap(d.y, d.z);
            break;
    }
    origin = world_.point(o);
    direction = normalize(world_.vector(d));
}

float Camera::jacobian(const Vec3f& d) const {
    switch (kind_) {
        case CameraKind::kPerspective: {
            const float c = dot(d, world_.z);
            return c > 0 ? 1 / (window_area_ * c * c * c) : 0;
        }
        case CameraKind::kOrthographic:
            return 1 / window_area_;
        case CameraKind::kSpherical:
            break;
    }
    if (mapping_ == SphericalMapping::kEqualArea) return kInv4Pi;
    const float c = dot(d, world_.y);
    return 1 / (2 * kPi * kPi * std::sqrt(std::max(1e-12f, 1 - c * c)));
}

bool Camera::film_of_window(float x, float y, float& u, float& v) const {
    u = (x - x0_) / (x1_ - x0_);
    v = (y - y1_) / (y0_ - y1_);
    return u >= -margin_.x && u < 1 + margin_.x && v >= -margin_.y && v < 1 + margin_.y;
}

bool Camera::film_position(const Vec3f& lens, const Vec3f& d, float& u, float& v) const {
    if (kind_ == CameraKind::kPerspective) {
        if (d.z <= 0) return false;
        return film_of_window(lens.x / focal_distance_ + d.x / d.z, lens.y / focal_distance_ + d.y / d.z, u, v);
    }
    const Vec3f up{d.x, d.z, d.y};  // pbrt's spherical camera looks at its poles along y
    if (mapping_ == SphericalMapping::kEqualArea) {
        const Vec2f p = square_from_sphere(up);
        u = p.x, v = p.y;
    } else {
        const double phi = std::atan2(static_cast<double>(up.y), static_cast<double>(up.x)) / (2 * std::numbers::pi);
        u = static_cast<float>(phi < 0 ? phi + 1 : phi);
        v = static_cast<float>(std::acos(std::clamp(static_cast<double>(up.z), -1.0, 1.0)) / std::numbers::pi);
    }
    u = std::min(u, 0x1.fffffep-1f);
    v = std::min(v, 0x1.fffffep-1f);
    return true;
}

bool Camera::connect(const Vec3f& p, float s, float t, CameraPoint& out) const {
    out.parallel = parallel();
    if (parallel()) {
        const Vec3f local = to_camera(p - world_.t);
        if (local.z <= 0 || !film_of_window(local.x, local.y, out.u, out.v)) return false;
        out.p = p - world_.z * local.z;
        out.w = world_.z;
        out.distance = local.z;
    } else {
        out.lens = lens_point(s, t);
        const Vec3f lens = on_lens(out.lens);
        out.p = world_.point(lens);
        const Vec3f to = p - out.p;
        out.distance = length(to);
        if (!(out.distance > 0)) return false;
        out.w = to / out.distance;
        if (!film_position(lens, to_camera(out.w), out.u, out.v)) return false;
    }
    out.jacobian = jacobian(out.w);
    return true;
}

bool Camera::hit_lens(const Vec3f& o, const Vec3f& d, float t_max, CameraPoint& out) const {
    const float c = dot(d, world_.z);
    if (!has_lens() || c >= 0) return false;
    const float t = dot(world_.t - o, world_.z) / c;
    if (!(t > 0 && t < t_max)) return false;
    const Vec3f lens = to_camera(o + d * t - world_.t);
    if (lens.x * lens.x + lens.y * lens.y > lens_radius_ * lens_radius_) return false;
    out.p = o + d * t;
    out.w = -d;
    out.distance = t;
    out.parallel = false;
    out.lens = {lens.x / lens_radius_, lens.y / lens_radius_};
    out.jacobian = jacobian(out.w);
    return film_position(lens, to_camera(out.w), out.u, out.v);
}

}  // namespace latent::render
