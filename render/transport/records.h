// render/transport/records.h: what a sample's paths carried, and how it becomes records. docs/rendering.md, "Records".
#pragma once

#include "color/observer.h"
#include "render/spectral/spectra.h"
#include "render/transport/integrator.h"

namespace latent::render {

// Sum of the contributions of paths to one film position. A path that was dispersed holds only the sample's kept wavelength: it
// counts k times, as that one was drawn out of k.
struct Radiance {
    SampledSpectrum sum{0.0f};
    bool has_all = false;  // some path was not dispersed

    void add(const SampledSpectrum& value, bool dispersed, std::uint32_t kept, std::uint32_t k) {
        if (dispersed) {
            sum[kept] += static_cast<float>(k) * value[kept];
        } else {
            sum += value;
            has_all = true;
        }
    }
};

// Writes records of one job. A record stores all k pairs if any path that kept them all contributed, the kept one alone if only
// dispersed paths did, and none if it is black.
class RecordMaker {
 public:
    explicit RecordMaker(sampledb::RecordKind kind);

    // Radiance that no light can have is counted and stored as black (camera) or not at all (light).
    void camera(std::uint64_t n, std::uint32_t u, std::uint32_t v, const Radiance& radiance, const Wavelengths& w,
                std::uint32_t kept, sampledb::Records& out, RadianceFaults& faults) const;
    void light(std::uint64_t n, float u, float v, const Radiance& radiance, const Wavelengths& w, std::uint32_t kept,
               sampledb::Records& out, RadianceFaults& faults) const;

 private:
    void put(std::uint64_t n, std::uint32_t u, std::uint32_t v, sampledb::RecordClass record_class, const Radiance& radiance,
             const Wavelengths& w, std::uint32_t kept, sampledb::Records& out, RadianceFaults& faults) const;

    sampledb::RecordKind kind_;
    color::IntegerNmSpectrum observer_[3];  // CIE 1931
};

}  // namespace latent::render
