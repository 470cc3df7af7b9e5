// render/camera/camera.h: from points of the film to rays, and back. docs/rendering.md, "Cameras".
#pragma once

#include <cstdint>

#include "base/result.h"
#include "render/math/vec.h"
#include "render/sampling/sampler.h"
#include "render/scene/description.h"

namespace latent::render {

// A point of the camera that a path ends at, seen from somewhere in the scene (or reached by a ray).
struct CameraPoint {
    Vec3f p;         // on the lens; orthographic: on the window
    Vec3f w;         // unit, from p towards the scene
    float distance;  // from the point in the scene
    float u, v;      // on the film, in [0,1); of 595 nm if the lens splits wavelengths
    Vec2f lens{};    // p on the unit disk of the lens; (0, 0) without one
    // |d(u,v) / d omega|, at p kept fixed, for directions about w; orthographic: |d(u,v) / dA|, A an area square to w.
    float jacobian;
    bool parallel;  // orthographic: rays of one direction, no spreading with distance
};

class Camera {
 public:
    // Errors: kUnsupported: the transformation skews or stretches; a lens on an orthographic camera.
    static Result<Camera> make(const CameraDescription& description);

    // The same elsewhere: of the kind and scale that `make` took.
    Camera moved_to(const Affined& world_from_camera) const;

    // The point of the unit disk that (s, t) draw, or the sample's numbers; (0, 0) without a lens.
    Vec2f lens_point(float s, float t) const;
    Vec2f lens_point(const SampleNumbers& numbers) const {
        return has_lens() ? lens_point(numbers(Dimension::kLensU), numbers(Dimension::kLensV)) : Vec2f{0, 0};
    }
    // The ray of film point (u, v) through that point of the lens.
    void ray(double u, double v, const Vec2f& lens, Vec3f& origin, Vec3f& direction) const;
    // |d(u,v) / d omega| for rays along unit d: their density [1/sr] as u, v are uniform. Orthographic: per area square to d.
    float jacobian(const Vec3f& d) const;
    bool parallel() const { return kind_ == CameraKind::kOrthographic; }

    // The lens point drawn with (s, t) as seen from p. False: p is not in the picture from there.
    bool connect(const Vec3f& p, float s, float t, CameraPoint& out) const;
    // Where a ray from o along unit d, shorter than t_max, meets the lens from the front. False: it does not, or outside of the
    // film.
    bool hit_lens(const Vec3f& o, const Vec3f& d, float t_max, CameraPoint& out) const;

    // Chromatic aberration: the focal distance f is linear in wavelength, and a ray that is drawn for 595 nm belongs to other film
    // points at other wavelengths [R06 8.3.3]. A film point and a lens point determine the ray's direction d at unit depth by
    //   window point = d + lens point / f(lambda),
    // so a wavelength's film point is that of 595 nm + spread x defocus(lambda), both in [0,1) or outside of the film.
    bool splits_wavelengths() const { return focal_slope_ != 0 && has_lens(); }
    double defocus(double lambda_nm) const {
        return 1 / (focal_distance_ + focal_slope_ * (lambda_nm - 595)) - 1 / focal_distance_;
    }
    // Film points at `lens` of the unit disk are spread over (u, v) + spread x defocus(lambda).
    Vec2f spread(const Vec2f& lens) const { return {lens.x * lens_radius_ / (x1_ - x0_), lens.y * lens_radius_ / (y0_ - y1_)}; }

    bool has_lens() const { return lens_radius_ > 0; }
    float lens_area() const { return kPi * lens_radius_ * lens_radius_; }
    const Vec3f& axis() const { return world_.z; }
    const Vec3f& center() const { return world_.t; }
    std::uint32_t medium() const { return medium_; }

 private:
    Camera() = default;
    Vec3f to_camera(const Vec3f& v) const { return {dot(v, world_.x), dot(v, world_.y), dot(v, world_.z)}; }
    Vec3f on_lens(const Vec2f& p) const { return {p.x * lens_radius_, p.y * lens_radius_, 0}; }  // in camera space
    // The film point of a ray through `lens` (camera space) along unit d. False: outside of the film in every wavelength.
    bool film_position(const Vec3f& lens, const Vec3f& d, float& u, float& v) const;
    bool film_of_window(float x, float y, float& u, float& v) const;

    CameraKind kind_ = CameraKind::kPerspective;
    SphericalMapping mapping_ = SphericalMapping::kEqualArea;
    Affinef world_;                              // orthonormal; may mirror
    float x0_ = -1, x1_ = 1, y0_ = -1, y1_ = 1;  // window; orthographic: in the world's lengths
    float window_area_ = 4;
    float lens_radius_ = 0, focal_distance_ = 1;  // in the world's lengths
    double focal_slope_ = 0;                      // per nm
    Vec2f margin_{0, 0};                          // that film points of 595 nm go beyond the film where another's lie in it
    std::uint32_t medium_ = kNone;
};

}  // namespace latent::render
