// render/bsdf/coat.h: the surface of a layer of clear matter: what light does where it enters and leaves the layer.
// docs/rendering.md, "Layers".
#pragma once

#include "render/bsdf/fresnel.h"
#include "render/bsdf/microfacet.h"

namespace latent::render {

// Directions in the layer are those in which light from below arrives at its surface: they point up too. Nothing is said about the
// compression of radiance: what enters the layer leaves it again.
struct Coat {
    Microfacets facets;
    float eta;  // index of the layer over that of the air above

    struct Refracted {
        Vec3f up;
        float weight = 0;  // share of the power that is refracted, over the density; 0: nothing
        float pdf = 0;     // [1/sr] in the layer; 0 of a delta function
    };

    bool is_smooth() const { return facets.are_smooth() || eta == 1; }

    // The macroscopic surface refracts `w` into the layer. False: total reflection.
    bool refract_in(const Vec3f& w, Vec3f& up) const {
        if (!refract(w, {0, 0, 1}, eta, up)) return false;
        up = -up;
        return up.z > 0;
    }
    // The same, out of the layer: light that arrives at the surface along `up` leaves towards w.
    bool refract_out(const Vec3f& up, Vec3f& w) const { return refract(-up, {0, 0, -1}, 1 / eta, w) && w.z > 0; }

    // f of reflection above; 0 of a smooth surface.
    float reflection(const Vec3f& a, const Vec3f& b) const {
        Vec3f m;
        if (is_smooth() || !half_vector(a, b, 1, m)) return 0;
        return fresnel_dielectric(dot(a, m), eta) * facets.density(m) * facets.masking_shadowing(a, b) / (4 * a.z * b.z);
    }
    float pdf_reflection(const Vec3f& a, const Vec3f& b) const {
        Vec3f m;
        return half_vector(a, b, 1, m) ? facets.visible_density(a, m) / (4 * dot(a, m)) : 0;
    }

    // Draws the direction in which `w` goes on in the layer, or from which it came.
    Refracted sample_refraction(const Vec3f& w, float u, float v) const {
        Refracted out;
        if (is_smooth()) {
            if (refract_in(w, out.up)) out.weight = 1 - fresnel_dielectric(w.z, eta);
            return out;
        }
        const Vec3f m = facets.sample_visible(w, u, v);
        Vec3f down;
        if (!refract(w, m, eta, down) || !(down.z < 0)) return out;
        out.up = -down;
        out.pdf = facets.visible_density(w, m) * refraction_jacobian(w, down, m, eta);
        out.weight = shadowed(w, down) * (1 - fresnel_dielectric(dot(w, m), eta));
        return out;
    }
    // For a rough surface and a given direction: `pdf` and `weight` as sampling would give them.
    Refracted refraction(const Vec3f& w, const Vec3f& up) const {
        Refracted out;
        out.up = up;
        Vec3f m;
        if (!half_vector(w, -up, eta, m)) return out;
        out.pdf = facets.visible_density(w, m) * refraction_jacobian(w, -up, m, eta);
        out.weight = shadowed(w, -up) * (1 - fresnel_dielectric(dot(w, m), eta));
        return out;
    }

    // Draws the direction, down, that light arriving along `up` is reflected to; weight: share of the power over the density.
    // Light that facets send up again is lost: 0.
    float sample_reflection_below(const Vec3f& up, float u, float v, Vec3f& down) const {
        if (is_smooth()) {
            down = {up.x, up.y, -up.z};
            return fresnel_dielectric(up.z, 1 / eta);
        }
        const Vec3f m = facets.sample_visible(-up, u, v);
        const float c = -dot(up, m);
        down = up + m * (2 * c);
        if (!(down.z < 0)) return 0;
        return shadowed(-up, down) * fresnel_dielectric(std::abs(c), 1 / eta);
    }

 private:
    // G2 / G1: visible to b too, of what a sees.
    float shadowed(const Vec3f& a, const Vec3f& b) const { return facets.masking_shadowing(a, b) / facets.masking(a); }
};

}  // namespace latent::render
