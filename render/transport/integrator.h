// render/transport/integrator.h: the contract between the program that counts samples and the light transport that makes them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "render/scene/description.h"
#include "render/scene/light_groups.h"
#include "render/texture/textures.h"
#include "render/transport/aov_settings.h"
#include "sampledb/data/film_position.h"
#include "sampledb/data/record.h"
#include "sampledb/data/wavelengths.h"

namespace latent::render {

enum class IntegratorKind : std::uint8_t { kPath, kBdpt };
enum class Connections : std::uint8_t { kOne, kAll };

struct IntegratorSettings {
    IntegratorKind kind = IntegratorKind::kPath;
    Connections connections = Connections::kOne;  // bdpt
    std::uint32_t max_depth = 5;                  // scattering vertices of a path; kUnlimited: no bound
    std::uint32_t batch = 28;                     // k, wavelengths of one sample
    sampledb::RecordKind record = sampledb::RecordKind::kSpectral;
    sampledb::PositionSamplerSpec positions{};  // where samples lie on the film, which decides on the sampler
    std::uint64_t seed = 0;
    std::string simd = "sse4.2";  // for Geometry; no record depends on it
    TextureSettings textures{};
    LightGroups light_groups{};
    AovSettings aovs{};
};

// Radiance that no light can have: each such record was stored as black.
struct RadianceFaults {
    std::uint64_t nan = 0, infinite = 0, negative = 0;
    RadianceFaults& operator+=(const RadianceFaults& b) {
        nan += b.nan;
        infinite += b.infinite;
        negative += b.negative;
        return *this;
    }
    std::uint64_t total() const { return nan + infinite + negative; }
};

class Integrator {
 public:
    virtual ~Integrator() = default;
    // Appends all records of sample n: a function of (scene, settings, n) alone. Any thread.
    virtual void trace(std::uint64_t n, sampledb::Records& out, RadianceFaults& faults) const = 0;
    // The density of wavelengths, from this scene's lights. Part of the job id; the headers of spectral jobs hold it.
    virtual const sampledb::WavelengthDensity& density() const = 0;
    virtual std::uint32_t light_paths_per_sample() const = 0;  // 0: no light image
    // An error: what has been traced since the last call without one is wrong. Any thread.
    virtual Status status() const { return {}; }
    // What the scene's files turned out to hold when they were needed, one line each. Any thread.
    virtual std::vector<std::string> warnings() const { return {}; }
    // Tests of visibility between two points since this was made; one may go on through interfaces. Not while a thread traces.
    virtual std::uint64_t shadow_rays() const { return 0; }
};

}  // namespace latent::render
