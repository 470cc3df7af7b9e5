// render/bsdf/inputs.h: what closures are made of: values by name, which a material evaluates where a path hits the surface.
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

// One of the values that a closure is made of. Numbers, values of textures and multiplied spectra become the nearest value within
// low..high, NaN becomes the lowest. Other constant spectra stay as they are.
struct Input {
    std::string_view name;
    InputRole role = InputRole::kSpectrum;
    float low = 0, high = 1;
    float otherwise = 0;           // a number or option that the material lacks; a spectrum is then black,
    bool may_be_missing = false;   // or null
    bool is_index = false;         // an index of refraction: what passes is dispersed if it varies with wavelength
    bool is_alpha = false;         // alpha of GGX facets, along local x or y
    bool is_directed = false;      // a number that, if it is not 0, needs to know where the coordinates of textures run
    std::string_view factor = {};  // the number, constant, that multiplies the spectrum

    static constexpr Input reflectance(std::string_view name) { return {.name = name}; }
    static constexpr Input index(std::string_view name) { return {.name = name, .low = 1e-3f, .high = 1e3f, .is_index = true}; }
    static constexpr Input number(std::string_view name, float otherwise, float low, float high) {
        return {.name = name, .role = InputRole::kNumber, .low = low, .high = high, .otherwise = otherwise};
    }
    static constexpr Input alpha(std::string_view name) {
        return {.name = name, .role = InputRole::kNumber, .high = 1e6f, .is_alpha = true};
    }
    static constexpr Input directed(std::string_view name, float otherwise) {
        return {.name = name, .role = InputRole::kNumber, .otherwise = otherwise, .is_directed = true};
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

// Whether each name is there once, and each factor is a number.
template <std::size_t N>
constexpr bool are_sound(const std::array<Input, N>& inputs) {
    return std::ranges::all_of(inputs, [&](const Input& input) {
        const auto is_factor = [&](const Input& other) { return other.name == input.factor && other.role == InputRole::kNumber; };
        return std::ranges::count(inputs, input.name, &Input::name) == 1 &&
               (input.factor.empty() || std::ranges::any_of(inputs, is_factor));
    });
}

// One of these, by its role.
struct InputValue {
    const SampledSpectrum* spectrum = nullptr;
    bool varies = false;  // an index: with wavelength
    float number = 0;
    std::uint32_t option = 0;
};

class MeasuredTables;

// What closures need besides their inputs: the place, and tables of measurements.
struct ClosureSite {
    SampledSpectra& spectra;  // the sample's: room for values, too
    std::uint32_t kept;       // the wavelength that a dispersed path keeps
    Vec3f p;
    bool ribbon;
    float across;                              // place across a ribbon: -1 to 1 along local y
    bool mirrored = false;                     // dp/dv lies against local y; for materials that have a direction
    const MeasuredTables* measured = nullptr;  // for a material that was measured
};

// The inputs of closure C at a point, by name: values.number("exponent"). A name that is not in C::kInputs does not compile, nor
// one that has another role, nor `spectrum` of one that may be missing.
template <class C>
class Values {
 public:
    template <InputRole role, bool may_be_missing = false>
    struct Name {
        std::size_t index = 0;
        consteval Name(const char* name) {
            while (C::kInputs.at(index).name != name) ++index;
            if (C::kInputs[index].role != role) throw "another role";
            if (C::kInputs[index].may_be_missing != may_be_missing)
                throw "use find for a spectrum that may be missing, and only for it";
        }
    };
    using SpectrumName = Name<InputRole::kSpectrum>;

    explicit Values(const ClosureSite& at) : site(at) {}

    const SampledSpectrum& spectrum(SpectrumName name) const { return *values_[name.index].spectrum; }
    const SampledSpectrum* find(Name<InputRole::kSpectrum, true> name) const { return values_[name.index].spectrum; }
    bool varies(SpectrumName name) const { return values_[name.index].varies; }
    float number(Name<InputRole::kNumber> name) const { return values_[name.index].number; }
    std::uint32_t option(Name<InputRole::kOption> name) const { return values_[name.index].option; }
    // The values of another closure, whose inputs are the first of these.
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
