// render/medium/heterogeneous.h: the common part of media whose density varies in space: tracking by tentative collisions.
// docs/rendering.md, "Media".
#pragma once

#include "render/medium/majorant_grid.h"
#include "render/medium/medium.h"

namespace latent::render {

class ScaledMedium;

// sigma_t at a point is at most mu = (density bound of the cell) x (largest reference sigma_t of the k wavelengths), one majorant
// for all wavelengths. Tentative collisions come at rate mu; each is real with probability sigma_t / mu, which differs from
// wavelength to wavelength. One wavelength, chosen by its share of the light, decides, and the balance heuristic between the k
// ways to make the same step weighs it [Miller19]. With a_j the quotient sigma_t / mu at the j-th tentative collision, and means
// weighted by the shares:
//   real at the n-th   value *= (1 - a_1) .. (1 - a_(n-1)) sigma_s / mu  over the mean of (1 - a_1) .. (1 - a_(n-1)) a_n
//   none real          value *= (1 - a_1) .. (1 - a_n)  over the mean of that
// Transmittance is the expectation of (1 - a_1) .. (1 - a_n), ratio tracking [Novak14].
class HeterogeneousMedium : public Medium {
 public:
    std::optional<Box> box() const override { return unit_cube_box(unit_from_world_.inverse().value_or(Affined{})); }
    bool is_tracked() const final { return true; }
    float deepest_cell(const SpectrumLibrary& library) const final;
    MediumStep sample_step(const Segment& segment, Uniform u_wavelength, Uniform u, SampleState& sample, SampledSpectrum& value,
                           SampledSpectrum* emitted) const final;
    MediumStep scatter_at(const Segment& segment, float t, SampleState& sample, SampledSpectrum& value) const final;
    MediumStep multiply_transmittance(const Segment& segment, SampleState& sample, SampledSpectrum& value) const final;
    float scattering_over_transmittance(const Vec3f& p, float column, SampleState& sample) const final;

    // At a point of the unit cube [1/m].
    virtual void extinction(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_t) const = 0;
    virtual void scattering(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_s) const = 0;
    // sigma_a times the emitted radiance. False: none.
    virtual bool emission(const Vec3f& p, SampleState& sample, SampledSpectrum& out) const = 0;
    const MajorantGrid& majorants() const { return majorants_; }

 protected:
    // `reference_sigma_t`: a spectrum of the library; times the density of `majorants` it bounds the extinction at all wavelengths.
    // Points of the medium's own space lie in the unit cube; beyond it the density is that of `outside` everywhere.
    HeterogeneousMedium(const PhaseFunction& phase, const Affined& unit_from_world, std::uint32_t reference_sigma_t,
                        MajorantGrid majorants, MajorantGrid::Cell outside = {0, 0})
        : Medium(phase),
          unit_from_world_(unit_from_world),
          reference_sigma_t_(reference_sigma_t),
          majorants_(std::move(majorants)),
          outside_(outside) {}

    std::uint32_t reference_sigma_t() const { return reference_sigma_t_; }
    Vec3f unit_point(const Vec3f& p) const { return Vec3f(unit_from_world_.point(Vec3d(p))); }
    static bool is_in_unit_cube(const Vec3f& q) { return std::min({q.x, q.y, q.z}) >= 0 && std::max({q.x, q.y, q.z}) <= 1; }

 private:
    // Coefficients mean nothing there.
    bool is_empty_at(const Vec3f& q) const { return outside_.max == 0 && !is_in_unit_cube(q); }
    struct UnitLine {
        Vec3f o, d;  // d: per metre
    };
    UnitLine unit_line(const Segment& segment) const;
    // null: sigma_t is not one spectrum times a density.
    virtual const ScaledMedium* scaled() const { return nullptr; }
    // f(extinction): in a value for each wavelength, or for each level of the spectrum that is scaled, if it has few.
    template <class F>
    auto with_extinction(SampleState& sample, F f) const;
    // Calls collide(t, point, mu) at the tentative collisions before `end`, the first one drawn by `u`. That returns the optical
    // depth to the next one, or kStop. Returns the column up to where it stopped, or up to `end`.
    template <class Collide>
    float track(const UnitLine& line, float end, float reference, float u, Collide collide) const;
    template <class Extinction>
    MediumStep sample_step(Extinction extinction, const Segment& segment, Uniform u_wavelength, Uniform u, SampleState& sample,
                           SampledSpectrum& value, SampledSpectrum* emitted) const;
    // value *= an estimate of the transmittance up to `end`; returns the column.
    template <class Extinction>
    float multiply_transmittance(Extinction& extinction, const UnitLine& line, float end, SampleState& sample,
                                 SampledSpectrum& value) const;

    Affined unit_from_world_;
    std::uint32_t reference_sigma_t_;
    MajorantGrid majorants_;
    MajorantGrid::Cell outside_;
};

// A density scales sigma_t, the reference of the majorants, and sigma_s.
class ScaledMedium : public HeterogeneousMedium {
 public:
    // At a point of the unit cube.
    virtual float density(const Vec3f& p) const = 0;
    std::uint32_t sigma_s() const { return sigma_s_; }
    void extinction(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_t) const final;
    void scattering(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_s) const final;

 protected:
    ScaledMedium(const PhaseFunction& phase, const Affined& unit_from_world, std::uint32_t sigma_t, std::uint32_t sigma_s,
                 MajorantGrid majorants)
        : HeterogeneousMedium(phase, unit_from_world, sigma_t, std::move(majorants)), sigma_s_(sigma_s) {}

 private:
    const ScaledMedium* scaled() const final { return this; }

    std::uint32_t sigma_s_;
};

}  // namespace latent::render
