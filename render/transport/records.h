// render/transport/records.h: what a sample's paths carried, and how it becomes records. docs/rendering.md, "Records".
#pragma once

#include <vector>

#include "color/observer.h"
#include "render/camera/camera.h"
#include "render/sampling/sample_state.h"
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
};

// The same for each group of lights.
class Radiance {
 public:
    Radiance(const LightGroups& groups, const SampleState& sample)
        : groups_(groups), kept_(sample.kept), k_(sample.k()), others_(groups.count - 1) {}

    // `light`: its id, or kNone for what no light emits.
    void add(const SampledSpectrum& value, bool dispersed, std::uint32_t light) {
        const std::uint32_t group = groups_.of(light);
        RadianceSum& to = group == 0 ? first_ : others_[group - 1];
        if (dispersed) {
            to.sum[kept_] += static_cast<float>(k_) * value[kept_];
        } else {
            to.sum += value;
            to.has_all = true;
        }
    }
    std::uint32_t groups() const { return groups_.count; }
    const RadianceSum& of(std::uint32_t group) const { return group == 0 ? first_ : others_[group - 1]; }

 private:
    const LightGroups& groups_;
    std::uint32_t kept_, k_;
    RadianceSum first_;
    std::vector<RadianceSum> others_;
};

inline constexpr std::uint32_t kAllWavelengths = 0xFFFFFFFF;

// How the records of one job are made.
class RecordMaker {
 public:
    RecordMaker(sampledb::RecordKind kind, const LightGroups& groups, const AovSettings& aovs);

    const LightGroups& groups() const { return groups_; }

 private:
    friend class SampleRecords;

    sampledb::RecordKind kind_;
    const LightGroups& groups_;
    AovSettings aovs_;
    std::vector<sampledb::ExtraColumn> columns_;  // both, without values
    // CIE 1931 at integer nm: its three values side by side, and a fourth, 0, for vectors.
    std::array<std::array<float, 4>, color::kIntegerNmCount> observer_{};
};

// Where records go, and what was wrong with their light.
struct RecordSink {
    sampledb::Records& records;
    RadianceFaults& faults;
};

// Writes the records of one sample: one for each group that has any light, the first with the sample's share; without groups one. A
// record stores all k pairs if any path that kept them all contributed, the kept one alone if only dispersed paths did, and none if
// it is black. Light that no light source can emit is counted and stored as black (camera) or not at all (light).
class SampleRecords {
 public:
    SampleRecords(const RecordMaker& maker, const SampleState& sample, const Camera& camera, RecordSink out)
        : maker_(maker), sample_(sample), camera_(camera), out_(out) {}

    // What the camera sees at a film position, floor(x 2^32). `only`: the wavelength that belongs there; the records of all of them
    // together have the sample's share.
    void camera(std::uint32_t u, std::uint32_t v, const Radiance& radiance, const Seen& seen, std::uint32_t only = kAllWavelengths);
    // What a path from a light brought to a point of the lens. A lens that splits wavelengths sends each to a film position of its
    // own; those beyond the film are left out.
    void light(const CameraPoint& point, const Radiance& radiance);

 private:
    struct Place {
        sampledb::RecordClass record_class;
        std::uint32_t u, v, only;
    };
    void put_groups(const Place& place, const Radiance& radiance, const Seen& seen);
    // `power`: null for a black record.
    void put(const Place& place, float share, const SampledSpectrum* power, bool has_all);
    void put_extra(std::uint32_t group, const Seen& seen);

    const RecordMaker& maker_;
    const SampleState& sample_;
    const Camera& camera_;
    RecordSink out_;
};

}  // namespace latent::render
