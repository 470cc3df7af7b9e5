// render/bsdf/measured.h: reflection as it was measured [DupuyJakob18]. docs/rendering.md, "Measured surfaces".
#pragma once

#include <array>
#include <memory>

#include "render/bsdf/closure.h"
#include "render/sampling/bilinear_warp.h"
#include "render/scene/measured_brdf.h"
#include "render/spectral/spectra.h"

namespace latent::render {

// A measurement, ready to be looked up. Directions have z > 0.
class MeasuredTables {
 public:
    explicit MeasuredTables(std::shared_ptr<const MeasuredBrdf> brdf);

    bool is_isotropic() const { return brdf_->is_isotropic(); }
    // Which tables the first direction uses, and where it lies in the square of directions.
    struct View {
        TableMixture mixture;
        Vec2f place;
        float sigma;
    };
    View view(const Vec3f& w) const;
    // The facet that reflects between a view's direction w and another one.
    struct Facet {
        Vec2f place, drawn;  // in the square of directions, and in the one that its places are drawn from
        float pdf_omega;     // the other direction's
    };
    bool facet(const View& view, const Vec3f& w, const Vec3f& other, Facet& out) const;  // false: there is none
    // Draws the other direction.
    Vec3f sample(const View& view, const Vec3f& w, float u, float v) const;
    // f times the cosine of the other direction, where `view` is of the camera's side; value *= that.
    void multiply_f_cos(const View& view, const Facet& facet, const Wavelengths& wavelengths, SampledSpectrum& value) const;
    // Share that is reflected at normal incidence.
    SampledSpectrum albedo(const Wavelengths& wavelengths) const;

 private:
    SampledSpectrum spectra_at(const View& view, const Vec2f& drawn, const Wavelengths& wavelengths) const;

    std::shared_ptr<const MeasuredBrdf> brdf_;
    BilinearWarp vndf_, luminance_;
};

// Tables are chosen by one direction and cover all others. As in pbrt-v4, that direction is w_camera on both kinds of subpath,
// since a measurement is only approximately reciprocal.
class Measured {
 public:
    static constexpr std::string_view kName = "measured";
    static constexpr std::array<Input, 0> kInputs = {};
    static constexpr bool kTransmits = false;

    explicit Measured(const Values<Measured>& v) : Measured(*v.site.measured, v.site.spectra.wavelengths) {}
    static bool is_isotropic(const Values<Measured>& v) { return v.site.measured->is_isotropic(); }
    Measured(const MeasuredTables& tables, const Wavelengths& wavelengths) : tables_(&tables), wavelengths_(&wavelengths) {}

    bool is_delta() const { return false; }
    SampledSpectrum albedo() const { return tables_->albedo(*wavelengths_); }
    bool disperses(const Vec3f&, const Vec3f&) const { return false; }
    void multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const;
    float pdf_omega(const Vec3f& wo, const Vec3f& wi) const;
    bool sample(const Vec3f& wo, float u_lobe, float u, float v, ClosureSample& out, SampledSpectrum& weight) const;

 private:
    const MeasuredTables* tables_;
    const Wavelengths* wavelengths_;
};

}  // namespace latent::render
