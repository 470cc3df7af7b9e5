// tests/transport/closure_examples.h: examples of every closure in the list, and of phase functions, with what their laws must know
// about them. A closure without examples does not link.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "render/transport/scattering.h"

namespace latent::render::testing {

template <class T>  // a closure, or PhaseFunction
struct Example {
    std::string name;
    T scatters;
    double eta = 1;                                    // of what refracts: behind the surface over before it
    std::optional<std::uint32_t> kept = std::nullopt;  // the wavelength that dispersion follows
    bool loses_nothing = false;
};

// Values in every wavelength that outlive the examples.
struct Values {
    SampledSpectrum black{0.0f}, grey{0.7f}, white{1.0f}, glass{1.5f}, rising, falling, varying, eta, k;
    Values() {
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
            rising[i] = 0.02f * static_cast<float>(i);
            falling[i] = 1 - rising[i];
            varying[i] = 1.7f + 0.003f * static_cast<float>(i);
            eta[i] = 0.3f + 0.04f * static_cast<float>(i);
            k[i] = 3.0f + 0.1f * static_cast<float>(i);
        }
    }
};
inline const Values& values() {
    static const Values v;
    return v;
}

template <class T>
std::vector<Example<T>> examples();

template <>
inline std::vector<Example<PhaseFunction>> examples() {
    return {{.name = "g = 0", .scatters = {0}, .loses_nothing = true},
            {.name = "g = 0.6", .scatters = {0.6f}, .loses_nothing = true},
            {.name = "g = -0.4", .scatters = {-0.4f}, .loses_nothing = true}};
}

template <>
inline std::vector<Example<Diffuse>> examples() {
    return {{.name = "grey", .scatters = Diffuse(values().grey)}};
}

template <>
inline std::vector<Example<Phong>> examples() {
    const Values& v = values();
    return {{.name = "wide lobe", .scatters = Phong(v.rising, v.falling, 3)},
            {.name = "narrow lobe", .scatters = Phong(v.falling, v.rising, 60)},
            {.name = "lobe alone, flat", .scatters = Phong(v.black, v.white, 0)},
            {.name = "no lobe", .scatters = Phong(v.white, v.black, 60)}};
}

template <>
inline std::vector<Example<Conductor>> examples() {
    const auto metal = [](float alpha_x, float alpha_y) { return Conductor(values().eta, values().k, alpha_x, alpha_y); };
    return {{.name = "alpha 0.3", .scatters = metal(0.3f, 0.3f)},
            {.name = "alpha 0.1 x 0.5", .scatters = metal(0.1f, 0.5f)},
            {.name = "alpha 0.8", .scatters = metal(0.8f, 0.8f)},
            {.name = "mirror", .scatters = metal(0, 0)}};
}

template <>
inline std::vector<Example<Dielectric>> examples() {
    const auto glass = [](float alpha_x, float alpha_y) { return Dielectric(values().glass, false, 3, alpha_x, alpha_y); };
    const auto flint = [](std::uint32_t kept, float alpha) { return Dielectric(values().varying, true, kept, alpha, alpha); };
    return {{.name = "alpha 0.2", .scatters = glass(0.2f, 0.2f), .eta = 1.5},
            {.name = "alpha 0.5 x 0.25", .scatters = glass(0.5f, 0.25f), .eta = 1.5},
            {.name = "alpha 0.4, dispersive", .scatters = flint(5, 0.4f), .eta = 1.715, .kept = 5},
            {.name = "smooth", .scatters = glass(0, 0), .eta = 1.5, .loses_nothing = true},
            {.name = "smooth, dispersive", .scatters = flint(9, 0), .eta = 1.727, .kept = 9, .loses_nothing = true}};
}

template <>
inline std::vector<Example<ThinDielectric>> examples() {
    return {{.name = "pane", .scatters = ThinDielectric(values().glass, false, 0), .loses_nothing = true},
            {.name = "dispersive pane", .scatters = ThinDielectric(values().varying, true, 9), .loses_nothing = true}};
}

template <>
inline std::vector<Example<MetallicRoughness>> examples() {
    const Values& v = values();
    using M = MetallicRoughness;
    return {{.name = "metal", .scatters = M(v.rising, {.metallic = 1, .alpha = 0.3f})},
            {.name = "plastic", .scatters = M(v.falling, {.alpha = 0.1f})},
            {.name = "white clay", .scatters = M(v.white, {.alpha = 0.8f, .f0 = 0.2f})},
            {.name = "blend", .scatters = M(v.rising, {.metallic = 0.4f, .alpha = 0.5f})},
            {.name = "white under a coat", .scatters = M(v.white, {.alpha = 0.6f, .coat = 1, .coat_alpha = 0.1f})},
            {.name = "blend, half coated, nothing at grazing",
             .scatters = M(v.falling, {.metallic = 0.5f, .alpha = 0.4f, .f90 = 0, .coat = 0.5f, .coat_alpha = 0.3f})}};
}

// What typed tests run over.
template <class List>
struct TypesOf;
template <class... C>
struct TypesOf<std::variant<C...>> {
    using Closures = ::testing::Types<C...>;
    using WithPhase = ::testing::Types<PhaseFunction, C...>;
};

// The last part of a type's name.
struct NameOf {
    template <class T>
    static std::string GetName(int) {
        const std::string whole = ::testing::internal::GetTypeName<T>();
        return whole.substr(whole.rfind(':') + 1);
    }
};

}  // namespace latent::render::testing
