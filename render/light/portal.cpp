#include "render/light/portal.h"

#include <numbers>

namespace latent::render {

// The rectangle about a point: from (x0, y0) to (x1, y1) of its own axes, `depth` outside.
struct Portal::Seen {
    double x0, x1, y0, y1, depth;

    Seen(const Portal& portal, const Vec3f& p) {
        const Vec3d to = portal.corner_ - Vec3d(p);
        x0 = dot(to, portal.x_), x1 = x0 + portal.width_;
        y0 = dot(to, portal.y_), y1 = y0 + portal.height_;
        depth = dot(to, portal.z_);
    }
    bool holds(double x, double y) const { return x >= x0 && x <= x1 && y >= y0 && y <= y1; }
};

// The solid angle, by the angles between the planes through the point and the edges [Urena13]. b: of the normals to the planes
// through y0 and y1, the component along z; k: 2 pi minus the angles at x0.
struct Portal::Cone {
    double b0, b1, k, solid_angle;

    explicit Cone(const Seen& s) {
        // Normals of neighbours are square to each other but for this component.
        const auto along_z = [&](double at) { return at / std::hypot(s.depth, at); };
        const double n0 = -along_z(s.y0), n1 = along_z(s.x1), n2 = along_z(s.y1), n3 = -along_z(s.x0);
        const auto angle = [](double a, double b) { return std::acos(std::clamp(-a * b, -1.0, 1.0)); };
        b0 = n0, b1 = n2;
        k = 2 * std::numbers::pi - angle(n2, n3) - angle(n3, n0);
        solid_angle = angle(n0, n1) + angle(n1, n2) - k;
    }
    // For a smaller one, the difference of angles has too few digits.
    bool is_wide() const { return solid_angle > 1e-4; }
};

Portal::Portal(const std::array<Vec3d, 4>& corners)
    : corner_(corners[0]),
      x_(normalize(corners[3] - corners[0])),
      y_(normalize(corners[1] - corners[0])),
      z_(normalize(cross(x_, y_))),
      width_(length(corners[3] - corners[0])),
      height_(length(corners[1] - corners[0])) {}

bool Portal::shows(const Vec3f& p, const Vec3f& w) const { return dot(corner_ - Vec3d(p), z_) > 0 && is_crossed(p, w); }

bool Portal::is_crossed(const Vec3f& p, const Vec3f& w) const {
    const Vec3d d(w);
    const double c = dot(d, z_);
    if (!(c > 0)) return false;
    const Seen seen(*this, p);
    const double t = seen.depth / c;
    return seen.holds(dot(d, x_) * t, dot(d, y_) * t);
}

bool Portal::sample(const Vec3f& p, Uniform u, Uniform v, Vec3f& w) const {
    const Seen s(*this, p);
    if (!(s.depth > 0)) return false;
    const double a = static_cast<double>(static_cast<float>(u)), b = static_cast<double>(static_cast<float>(v));
    double x = s.x0 + a * width_, y = s.y0 + b * height_;
    if (const Cone cone(s); cone.is_wide()) {
        const double phi = a * cone.solid_angle + cone.k;
        const double f = (std::cos(phi) * cone.b0 - cone.b1) / std::sin(phi);
        const double cosine = std::clamp(std::copysign(1.0, f) / std::hypot(f, cone.b0), -1.0, 1.0);
        x = std::clamp(cosine * s.depth / std::sqrt(std::max(1e-300, 1 - cosine * cosine)), s.x0, s.x1);
        const double ring = std::hypot(x, s.depth), h0 = s.y0 / std::hypot(ring, s.y0), h1 = s.y1 / std::hypot(ring, s.y1);
        const double h = h0 + b * (h1 - h0);
        y = std::clamp(h * ring / std::sqrt(std::max(1e-300, 1 - h * h)), s.y0, s.y1);
    }
    w = Vec3f(normalize(x_ * x + y_ * y + z_ * s.depth));
    return true;
}

float Portal::pdf_omega(const Vec3f& p, const Vec3f& w) const {
    const Seen s(*this, p);
    if (!(s.depth > 0)) return 0;
    if (const Cone cone(s); cone.is_wide()) return static_cast<float>(1 / cone.solid_angle);
    const double c = dot(Vec3d(w), z_);
    return static_cast<float>(s.depth * s.depth / (c * c * c * area()));
}

}  // namespace latent::render
