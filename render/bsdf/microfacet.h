// render/bsdf/microfacet.h: the GGX (Trowbridge-Reitz) distribution of facet normals, anisotropic. Directions are local, z the
// shading normal.
#pragma once

#include <algorithm>
#include <cmath>

#include "render/math/vec.h"
#include "render/sampling/warp.h"

namespace latent::render {

struct Microfacets {
    float alpha_x, alpha_y;

    static Microfacets of_alpha(float x, float y) { return {std::max(x, 1e-4f), std::max(y, 1e-4f)}; }
    // Rougher, facets have a density; smoother is a mirror [PBRT4 9.6.1].
    bool are_smooth() const { return std::max(alpha_x, alpha_y) < 1e-3f; }

    // Alpha of isotropic facets whose albedo is about that of these.
    float mean_alpha() const { return 0.5f * (alpha_x + alpha_y); }

    // D(m) = 1 / (pi ax ay cos^4 (1 + tan^2 (cos^2 phi / ax^2 + sin^2 phi / ay^2))^2), written without quotients of cosines
    // [WMLT07].
    float density(const Vec3f& m) const {
        const float x = m.x / alpha_x, y = m.y / alpha_y;
        const float s = x * x + y * y + m.z * m.z;
        return 1 / (kPi * alpha_x * alpha_y * s * s);
    }
    // Smith's Lambda(w) = (sqrt(1 + (ax^2 x^2 + ay^2 y^2) / z^2) - 1) / 2 [Heitz14].
    float lambda(const Vec3f& w) const {
        const float z2 = w.z * w.z;
        if (z2 == 0) return kInfinity;
        const float x = alpha_x * w.x, y = alpha_y * w.y;
        return 0.5f * (std::sqrt(1 + (x * x + y * y) / z2) - 1);
    }
    float masking(const Vec3f& w) const { return 1 / (1 + lambda(w)); }
    float masking_shadowing(const Vec3f& a, const Vec3f& b) const { return 1 / (1 + lambda(a) + lambda(b)); }  // height-correlated

    // Facet normals as `w` (either side) sees them: D_w(m) = G1(w) max(0, w.m) D(m) / |w.z|; m.z > 0.
    float visible_density(const Vec3f& w, const Vec3f& m) const { return masking(w) * abs_dot(w, m) * density(m) / std::abs(w.z); }
    Vec3f sample_visible(const Vec3f& w, float u, float v) const {  // [Heitz18]
        Vec3f h = normalize(Vec3f{alpha_x * w.x, alpha_y * w.y, w.z});
        if (h.z < 0) h = -h;
        const float along = h.x * h.x + h.y * h.y;
        const Vec3f t1 = along > 0 ? Vec3f{-h.y, h.x, 0} / std::sqrt(along) : Vec3f{1, 0, 0};
        const Vec3f t2 = cross(h, t1);
        Vec2f p = sample_disk(u, v);
        const float s = 0.5f * (1 + h.z);
        p.y = (1 - s) * std::sqrt(std::max(0.0f, 1 - p.x * p.x)) + s * p.y;
        const float z = std::sqrt(std::max(0.0f, 1 - p.x * p.x - p.y * p.y));
        const Vec3f m = t1 * p.x + t2 * p.y + h * z;
        return normalize(Vec3f{alpha_x * m.x, alpha_y * m.y, std::max(1e-6f, m.z)});
    }
};

// The facet normal, z > 0, that reflects `a` into `b`, or refracts it there if `eta` (b's side over a's) is not 1.
// False: none, or it faces away from one of the two.
inline bool half_vector(const Vec3f& a, const Vec3f& b, float eta, Vec3f& m) {
    const Vec3f sum = a + b * eta;
    const float squared = length_squared(sum);
    if (!(squared > 0) || a.z == 0 || b.z == 0) return false;
    m = sum / std::sqrt(squared);
    if (m.z < 0) m = -m;
    return dot(m, a) * a.z > 0 && dot(m, b) * b.z > 0;
}

// d omega_m / d omega_b of refraction: |b.m| / (b.m + a.m / eta)^2 [WMLT07].
inline float refraction_jacobian(const Vec3f& a, const Vec3f& b, const Vec3f& m, float eta) {
    const float denominator = dot(b, m) + dot(a, m) / eta;
    return abs_dot(b, m) / (denominator * denominator);
}

}  // namespace latent::render
