// render/bsdf/inputs.h: what closures are made of: values by name, which a material evaluates where a path meets the surface.
// docs/rendering.md, "Surfaces".
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "render/math/vec.h"
#include "render/spectral/spectra.h"

namespace latent::render {

enum class InputRole : std::uint8_t { kSpectrum, kNumber, kOption };  // an option: a flag, choice or count

// One of the values that a closure is made of. Constant numbers and what textures give become the nearest value within low..high,
// and what is no number the lowest; constant spectra stay as they are.
struct Input {
    std::string_view name;
    InputRole role = InputRole::kSpectrum;
    float low = 0, high = 1;
    float otherwise = 0;           // if the material does not have it; a spectrum is then black, or,
    bool may_be_missing = false;   // if this, null
    bool is_index = false;         // of refraction: what passes is dispersed if it varies with wavelength
    bool is_alpha = false;         // of GGX facets, along local x or y
    std::string_view factor = {};  // the number, constant, that multiplies the spectrum

    static constexpr Input reflectance(std::string_view name) { return {.name = name}; }
    static constexpr Input index(std::string_view name) { return {.name = name, .is_index = true}; }
    static constexpr Input number(std::string_view name, float otherwise, float low, float high) {
        return {.name = name, .role = InputRole::kNumber, .low = low, .high = high, .otherwise = otherwise};
    }
    static constexpr Input alpha(std::string_view name) {
        return {.name = name, .role = InputRole::kNumber, .high = 1e6f, .is_alpha = true};
    }
    static constexpr Input option(std::string_view name, float otherwise) {
        return {.name = name, .role = InputRole::kOption, .otherwise = otherwise};
    }
};

template <std::size_t N, std::size_t M>
constexpr std::array<Input, N + M> joined(const std::array<Input, N>& a, const std::array<Input, M>& b) {
    std::array<Input, N + M> all;
    std::ranges::copy(b, std::ranges::copy(a, all.begin()).out);
    return all;
}

// One of these, by its role.
struct InputValue {
    const SampledSpectrum* spectrum = nullptr;
    bool varies = false;  // an index: with wavelength
    float number = 0;
    std::uint32_t option = 0;
};

// What else a closure may depend on.
struct ClosureSite {
    SampledSpectra& spectra;  // of the sample: room for values, too
    std::uint32_t kept;       // the wavelength that a dispersed path keeps
    Vec3f p;
    bool ribbon;
    float across;  // of a ribbon: -1 to 1 along local y
};

// The inputs of closure C at a point, by name: values.number("exponent"). A name that is not in C::kInputs, or has another role,
// does not compile.
template <class C>
class Values {
 public:
    template <InputRole role>
    struct Name {
        std::size_t index = 0;
        consteval Name(const char* name) {
            while (C::kInputs.at(index).name != name) ++index;
            if (C::kInputs[index].role != role) throw "another role";
        }
    };
    using SpectrumName = Name<InputRole::kSpectrum>;

    explicit Values(const ClosureSite& at) : site(at) {}

    const SampledSpectrum& spectrum(SpectrumName name) const { return *values_[name.index].spectrum; }
    const SampledSpectrum* find(SpectrumName name) const { return values_[name.index].spectrum; }
    bool varies(SpectrumName name) const { return values_[name.index].varies; }
    float number(Name<InputRole::kNumber> name) const { return values_[name.index].number; }
    std::uint32_t option(Name<InputRole::kOption> name) const { return values_[name.index].option; }
    // Of another closure whose inputs are the first of these.
    template <class Part>
    Values<Part> of() const {
        Values<Part> part(site);
        for (std::size_t i = 0; i < Part::kInputs.size(); ++i) part[i] = values_[i];
        return part;
    }
    InputValue& operator[](std::size_t i) { return values_[i]; }

    ClosureSite site;

 private:
    std::array<InputValue, C::kInputs.size()> values_{};
};

}  // namespace latent::render
