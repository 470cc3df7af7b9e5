#include "render/texture/footprint.h"

namespace latent::render {

namespace {
constexpr double kShare = 0.25;  // part of a pixel's width: the samples of a pixel overlap, and what a filter blurs stays blurred
constexpr float kGrazing = 0.01f;
}  // namespace

Footprint::Footprint(const CameraDescription& camera, std::uint32_t width, std::uint32_t height)
    : center_(camera.world_from_camera.t),
      axis_(normalize(camera.world_from_camera.z)),
      parallel_(camera.kind == CameraKind::kOrthographic),
      min_cosine_(1) {
    const double x = std::abs(camera.x1 - camera.x0) / width, y = std::abs(camera.y1 - camera.y0) / height;
    double size = std::min(x, y);
    switch (camera.kind) {
        case CameraKind::kPerspective: {
            const double reach_x = std::max(std::abs(camera.x0), std::abs(camera.x1)),
                         reach_y = std::max(std::abs(camera.y0), std::abs(camera.y1));
            min_cosine_ = static_cast<float>(1 / std::sqrt(1 + reach_x * reach_x + reach_y * reach_y));
            break;
        }
        case CameraKind::kOrthographic:
            size *= length(camera.world_from_camera.x);
            break;
        case CameraKind::kSpherical:
            size = std::sqrt(4 * std::numbers::pi / (static_cast<double>(width) * height));
            break;
    }
    size_ = static_cast<float>(kShare * size);
    if (!camera.end) return;
    way_ = Vec3f(camera.end->t - camera.world_from_camera.t);
    turns_ = camera.end->x != camera.world_from_camera.x || camera.end->y != camera.world_from_camera.y ||
             camera.end->z != camera.world_from_camera.z;
}

void Footprint::at(const Vec3f& p, const Vec3f& n, Vec3f& dpdx, Vec3f& dpdy) const {
    Vec3f w = axis_;
    float size = size_;
    if (!parallel_) {
        Vec3f to = p - center_;
        if (way_ != Vec3f{}) to += -(way_ * std::clamp(dot(to, way_) / length_squared(way_), 0.0f, 1.0f));
        const float distance = length(to);
        if (!(distance > 0)) {
            dpdx = dpdy = {};
            return;
        }
        w = to / distance;
        // A pixel of a plane film is seen under a smaller angle away from its centre.
        const float c = turns_ ? min_cosine_ : std::clamp(dot(w, axis_), min_cosine_, 1.0f);
        size *= distance * c * c;
    }
    const float cosine = std::max(abs_dot(w, n), kGrazing);
    const Vec3f across = cross(n, w);
    const float sine = length(across);
    const Frame frame = Frame::from_z(n);
    const Vec3f x = sine > 1e-4f ? across / sine : frame.x;
    dpdx = x * size;
    dpdy = cross(n, x) * (size / cosine);
}

}  // namespace latent::render
