// render/spectral/spectra.h: the wavelengths of one sample, and every spectrum of a scene evaluated at them. docs/rendering.md,
// "Wavelengths".
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "color/spectrum.h"
#include "render/spectral/arena.h"
#include "render/spectral/levels.h"
#include "render/spectral/sampled_spectrum.h"
#include "sampledb/data/wavelengths.h"

namespace latent::render {

// k wavelengths and where they lie in tables of one value per nm.
struct Wavelengths {
    std::uint32_t k = 0;
    std::uint32_t xi = 0;
    float lambda_nm[kMaxWavelengths];        // ascending; those from k on repeat the last one
    std::uint32_t below[kMaxWavelengths];    // floor(lambda) - 360, at most 469
    float fraction[kMaxWavelengths];         // lambda - floor(lambda)
    std::uint32_t nearest[kMaxWavelengths];  // round(lambda) - 360
    SampledSpectrum weight;                  // 1 / (k p(lambda_i)); 0 from k on
};

// Draws Wavelengths from a density, as sampledb::WavelengthDensity::batch does, with the density at each.
class WavelengthSampler {
 public:
    WavelengthSampler(const sampledb::WavelengthDensity& density, std::uint32_t k);
    void draw(std::uint32_t xi, Wavelengths& out) const;

 private:
    sampledb::WavelengthDensity density_;
    std::uint32_t k_;
    std::vector<float> weight_;  // 1 / (k slope) after each knot
};

// How a spectrum is looked up.
enum class Lookup : std::uint8_t {
    kNearestNm,  // the sample at the nearest integer nm: pbrt's rule for lights and media [PBRT4 4.5]
    kLinear,     // exactly piecewise linear: reflectances, indices of refraction
};

// One spectrum, ready to be evaluated.
class SpectrumTable {
 public:
    // With kLinear, knots that all lie on integer nm are joined through a table of one value per nm, which is the same function;
    // others are walked along with the (ascending) wavelengths. Lights with knots nearer than 1 nm to each other (lines) are walked
    // too, as no table of integer nm could hold them.
    SpectrumTable(const color::Spectrum& s, Lookup lookup);
    void evaluate(const Wavelengths& w, SampledSpectrum& out) const;
    float max_value() const { return *std::max_element(value_.begin(), value_.end()); }
    bool operator==(const SpectrumTable&) const = default;

 private:
    enum class Form : std::uint8_t { kConstant, kNearest, kLinear, kKnots };
    Form form_ = Form::kConstant;
    std::vector<float> knot_nm_;  // kKnots, padded with a zero or a repeated value at both ends
    std::vector<float> value_;
};

// All spectra of a scene, by number; equal ones are stored once.
class SpectrumLibrary {
 public:
    std::uint32_t add(const color::Spectrum& s, Lookup lookup);
    const SpectrumTable& operator[](std::uint32_t id) const { return tables_[id]; }
    std::size_t size() const { return tables_.size(); }

 private:
    std::vector<SpectrumTable> tables_;
};

// Values at one sample's wavelengths: a scene's spectra, each evaluated when it is first used, and what holds at one point alone.
// One per thread, used sample after sample; all values live until the next sample starts.
class SampledSpectra {
 public:
    explicit SampledSpectra(const SpectrumLibrary& library) : library_(library), evaluated_(library.size()) {}

    Wavelengths wavelengths;

    void start_sample() {  // after `wavelengths` changed
        ++now_;
        arena_.clear();
    }
    const SampledSpectrum& operator[](std::uint32_t id) {
        Evaluated& spectrum = evaluated_[id];
        if (spectrum.sample != now_) {
            SampledSpectrum& value = arena_.allocate();
            library_[id].evaluate(wavelengths, value);
            spectrum = {&value, now_, nullptr};
        }
        return *spectrum.value;
    }
    // The different values of that.
    const SpectrumLevels& levels(std::uint32_t id) {
        const SampledSpectrum& value = (*this)[id];
        Evaluated& spectrum = evaluated_[id];
        if (spectrum.levels == nullptr) {
            const auto allocate = [this]() -> SampledSpectrum& { return arena_.allocate(); };
            spectrum.levels = &arena_.store(SpectrumLevels::of(value, wavelengths.k, allocate));
        }
        return *spectrum.levels;
    }
    // Room for a value that no spectrum of the scene has, such as a reflectance that varies over a surface. Not initialised.
    SampledSpectrum& allocate() { return arena_.allocate(); }
    template <class T>
    const T& store(const T& value) {
        return arena_.store(value);
    }

 private:
    struct Evaluated {
        const SampledSpectrum* value = nullptr;
        std::uint64_t sample = 0;
        const SpectrumLevels* levels = nullptr;  // if they were asked for
    };

    const SpectrumLibrary& library_;
    std::vector<Evaluated> evaluated_;
    SpectrumArena arena_;
    std::uint64_t now_ = 1;
};

}  // namespace latent::render
