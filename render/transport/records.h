// render/transport/records.h: what a sample's paths carried, and how it becomes records. docs/rendering.md, "Records".
#pragma once

#include <vector>

#include "color/observer.h"
#include "render/scene/light_groups.h"
#include "render/spectral/spectra.h"
#include "render/transport/aovs.h"
#include "render/transport/integrator.h"

namespace latent::render {

// Sum of the contributions of paths to one film position. A path that was dispersed holds only the sample's kept wavelength: it
// counts k times, as that one was drawn out of k.
struct RadianceSum {
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

// The same for each group of lights.
class Radiance {
 public:
    explicit Radiance(const LightGroups& groups) : groups_(groups), others_(groups.count - 1) {}

    // `light`: its id, or kNone for what no light emits.
    void add(const SampledSpectrum& value, bool dispersed, std::uint32_t kept, std::uint32_t k, std::uint32_t light) {
        const std::uint32_t group = groups_.of(light);
        (group == 0 ? first_ : others_[group - 1]).add(value, dispersed, kept, k);
    }
    std::uint32_t groups() const { return groups_.count; }
    const RadianceSum& of(std::uint32_t group) const { return group == 0 ? first_ : others_[group - 1]; }

 private:
    const LightGroups& groups_;
    RadianceSum first_;
    std::vector<RadianceSum> others_;
};

inline constexpr std::uint32_t kAllWavelengths = 0xFFFFFFFF;

// Writes records of one job: one of each group that has any light, the first with the sample's share; without groups one. A record
// stores all k pairs if any path that kept them all contributed, the kept one alone if only dispersed paths did, and none if it is
// black. Of a lens that splits wavelengths, each has records of its own, all of them together the sample's share.
class RecordMaker {
 public:
    RecordMaker(sampledb::RecordKind kind, bool with_groups, const AovSettings& aovs);

    // Radiance that no light can have is counted and stored as black (camera) or not at all (light).
    // `only`: the wavelength that goes to this film position, or all. `seen`: if AOVs are wanted.
    void camera(std::uint64_t n, std::uint32_t u, std::uint32_t v, const Radiance& radiance, const Seen& seen, const Wavelengths& w,
                std::uint32_t kept, sampledb::Records& out, RadianceFaults& faults, std::uint32_t only = kAllWavelengths) const;
    void light(std::uint64_t n, float u, float v, const Radiance& radiance, const Wavelengths& w, std::uint32_t kept,
               sampledb::Records& out, RadianceFaults& faults, std::uint32_t only = kAllWavelengths) const;

 private:
    void put_groups(std::uint64_t n, std::uint32_t u, std::uint32_t v, sampledb::RecordClass record_class, const Radiance& radiance,
                    const Seen& seen, const Wavelengths& w, std::uint32_t kept, std::uint32_t only, sampledb::Records& out,
                    RadianceFaults& faults) const;
    void put(std::uint64_t n, std::uint32_t u, std::uint32_t v, sampledb::RecordClass record_class, float share, bool has_all,
             const SampledSpectrum* power, const Wavelengths& w, std::uint32_t kept, sampledb::Records& out) const;

    sampledb::RecordKind kind_;
    bool with_groups_;
    AovSettings aovs_;
    std::vector<sampledb::ExtraColumn> columns_;  // of these, without values
    // CIE 1931 at integer nm: its three values side by side, and a fourth, 0, for vectors.
    std::array<std::array<float, 4>, color::kIntegerNmCount> observer_{};
};

}  // namespace latent::render
