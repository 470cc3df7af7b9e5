// render/transport/transport.h: what the integrators share: the scene, the numbers and the wavelengths of a sample, the way into
// records.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <memory>
#include <vector>

#include "render/sampling/sample_state.h"
#include "render/sampling/sampler.h"
#include "render/transport/integrator.h"
#include "render/transport/records.h"
#include "render/world/world.h"

namespace latent::render {

// Probability that a path goes on, from its throughput since it left the camera or the light. The eta^2 of radiance in denser media
// is no loss. A dispersed path is judged by the wavelength that it keeps. From the 64th scattering on it is at most 0.95: light
// that nothing absorbs and nothing lets out, reflected totally in a block of glass, must end too. In a medium it is at most 0.999,
// as light takes many steps there to find its way out.
inline float survival_probability(const SampledSpectrum& beta, float eta2, bool dispersed, std::uint32_t kept, bool in_medium,
                                  std::size_t scatterings) {
    const float probability = (dispersed ? beta[kept] : beta.max()) * eta2;
    const float most = in_medium ? 0.999f : 0.95f;
    return scatterings < 64 || probability < most ? probability : most;
}

// One sample: its numbers, the camera at its time, and the way into records.
struct TracedSample {
    SampleState& state;
    const Camera& camera;
    SampleRecords& records;
};

class Transport : public Integrator {
 public:
    Transport(std::unique_ptr<World> world, const IntegratorSettings& settings);

    void trace(std::uint64_t n, sampledb::Records& out, RadianceFaults& faults) const final;
    const sampledb::WavelengthDensity& density() const final { return density_; }
    std::uint32_t light_paths_per_sample() const override { return 0; }
    Status status() const final { return world_->textures().status(); }
    std::vector<std::string> warnings() const final { return world_->textures().warnings(); }
    std::uint64_t shadow_rays() const final;

 protected:
    // Adds to `seen` what the camera sees at film point (u, v); may write light records, unless the same sample is traced `again`
    // from another film point.
    virtual void trace_paths(const TracedSample& sample, Vec2d film, bool again, Radiance& seen) const = 0;

    const World& world() const { return *world_; }
    const IntegratorSettings& settings() const { return settings_; }

 private:
    void trace_split(const TracedSample& sample, Vec2d film) const;
    Seen look(const TracedSample& sample, Vec2d film) const;

    std::unique_ptr<World> world_;
    IntegratorSettings settings_;
    sampledb::WavelengthDensity density_;
    WavelengthSampler wavelengths_;
    std::unique_ptr<const Sampler> sampler_;
    RecordMaker records_;
    Aovs aovs_;
    struct OfThread {
        SampledSpectra spectra;  // a cache of single samples: nothing outlives one
        std::uint64_t shadow_rays = 0;
    };
    mutable tbb::enumerable_thread_specific<OfThread> of_thread_;
};

std::unique_ptr<const Sampler> make_sampler(const sampledb::PositionSamplerSpec& positions, std::uint64_t seed, const World& world);

}  // namespace latent::render
