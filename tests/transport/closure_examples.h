// tests/transport/closure_examples.h: examples of every closure in the list, and of phase functions, with what their laws must know
// about them. A closure without examples does not link.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "render/spectral/spectra.h"
#include "render/transport/scattering.h"
#include "tests/transport/measured_examples.h"

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
    SampledSpectrum black{0.0f}, grey{0.7f}, white{1.0f}, glass{1.5f}, half{0.5f}, half_rising, half_falling, rising, falling,
        varying, eta, k;
    Values() {
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
            rising[i] = 0.02f * static_cast<float>(i);
            falling[i] = 1 - rising[i];
            half_rising[i] = 0.5f * rising[i];
            half_falling[i] = 0.5f * falling[i];
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

// At wavelengths of all colours, for what needs to know them.
inline SampledSpectra& sampled() {
    static const SpectrumLibrary none;
    static SampledSpectra spectra(none);
    spectra.wavelengths.k = kMaxWavelengths;
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) spectra.wavelengths.lambda_nm[i] = 365 + 14 * static_cast<float>(i);
    return spectra;
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
            {.name = "no lobe", .scatters = Phong(v.white, v.black, 60)},
            {.name = "retro", .scatters = Phong(v.falling, v.rising, 12, true)}};
}

template <>
inline std::vector<Example<PhongTransmission>> examples() {
    const Values& v = values();
    using T = PhongTransmission;
    return {{.name = "straight", .scatters = T(v.rising, v.falling, 3, 1)},
            {.name = "narrow lobe, straight", .scatters = T(v.falling, v.rising, 60, 1)},
            {.name = "refracted", .scatters = T(v.rising, v.falling, 12, 1.5f), .eta = 1.5},
            {.name = "lobe alone, refracted", .scatters = T(v.black, v.white, 40, 1.5f), .eta = 1.5},
            {.name = "refracted into air", .scatters = T(v.half, v.half, 5, 0.75f), .eta = 0.75},
            {.name = "no lobe", .scatters = T(v.white, v.black, 60, 1), .loses_nothing = true}};
}

template <>
inline std::vector<Example<Conductor>> examples() {
    const auto metal = [](float alpha_x, float alpha_y) { return Conductor(values().eta, values().k, alpha_x, alpha_y); };
    return {{.name = "alpha 0.3", .scatters = metal(0.3f, 0.3f)},
            {.name = "alpha 0.1 x 0.5", .scatters = metal(0.1f, 0.5f)},
            {.name = "alpha 0.8", .scatters = metal(0.8f, 0.8f)},
            {.name = "alpha 0.8, multiscatter", .scatters = Conductor(values().eta, values().k, 0.8f, 0.8f, false, true)},
            {.name = "mirror", .scatters = metal(0, 0)},
            {.name = "retro, alpha 0.1 x 0.4", .scatters = Conductor(values().eta, values().k, 0.1f, 0.4f, true)},
            {.name = "retro mirror", .scatters = Conductor(values().eta, values().k, 0, 0, true)}};
}

template <>
inline std::vector<Example<Dielectric>> examples() {
    const auto glass = [](float alpha_x, float alpha_y) { return Dielectric(values().glass, false, 3, alpha_x, alpha_y); };
    const auto flint = [](std::uint32_t kept, float alpha) { return Dielectric(values().varying, true, kept, alpha, alpha); };
    const auto tinted = [](float alpha) { return Dielectric(values().glass, false, 3, alpha, alpha, &values().falling); };
    const auto all_tinted = [](float alpha, bool multiscatter) {
        return Dielectric(values().glass, false, 3, alpha, alpha, &values().falling, {}, nullptr, {}, multiscatter,
                          &values().falling);
    };
    const auto filmed = [](float alpha) {
        return Dielectric(values().glass, false, 3, alpha, alpha, nullptr, {.share = 0.8f, .eta = 2, .thickness_nm = 300},
                          &sampled().wavelengths);
    };
    return {{.name = "alpha 0.2", .scatters = glass(0.2f, 0.2f), .eta = 1.5},
            {.name = "alpha 0.5 x 0.25", .scatters = glass(0.5f, 0.25f), .eta = 1.5},
            {.name = "alpha 0.4, dispersive", .scatters = flint(5, 0.4f), .eta = 1.715, .kept = 5},
            {.name = "alpha 0.3, tinted", .scatters = tinted(0.3f), .eta = 1.5},
            {.name = "smooth, tinted", .scatters = tinted(0), .eta = 1.5},
            {.name = "smooth", .scatters = glass(0, 0), .eta = 1.5, .loses_nothing = true},
            {.name = "smooth, dispersive", .scatters = flint(9, 0), .eta = 1.727, .kept = 9, .loses_nothing = true},
            {.name = "smooth, under a film", .scatters = filmed(0), .eta = 1.5, .loses_nothing = true},
            {.name = "alpha 0.3, under a film", .scatters = filmed(0.3f), .eta = 1.5},
            {.name = "alpha 0.2, brushed",
             .scatters = Dielectric(values().glass, false, 3, 0.2f, 0.2f, nullptr, {}, nullptr, {0.7f, {0.6f, 0.8f}}),
             .eta = 1.5},
            {.name = "alpha 0.6, multiscatter, tinted",
             .scatters = Dielectric(values().glass, false, 3, 0.6f, 0.6f, &values().falling, {}, nullptr, {}, true),
             .eta = 1.5},
            {.name = "smooth, its reflection tinted", .scatters = all_tinted(0, false), .eta = 1.5},
            {.name = "alpha 0.6, multiscatter, its reflection tinted", .scatters = all_tinted(0.6f, true), .eta = 1.5}};
}

template <>
inline std::vector<Example<ThinDielectric>> examples() {
    return {{.name = "pane", .scatters = ThinDielectric(values().glass, false, 0), .loses_nothing = true},
            {.name = "tinted pane", .scatters = ThinDielectric(values().varying, true, 9, 0, 0, &values().falling)},
            {.name = "dispersive pane", .scatters = ThinDielectric(values().varying, true, 9), .loses_nothing = true},
            {.name = "pane under films",
             .scatters = ThinDielectric(values().glass, false, 0, 0, 0, nullptr, {.share = 1, .eta = 1.33f, .thickness_nm = 500},
                                        &sampled().wavelengths),
             .loses_nothing = true},
            {.name = "frosted pane", .scatters = ThinDielectric(values().glass, false, 0, 0.3f, 0.3f)},
            {.name = "pane, alpha 0.5 x 0.2, tinted, dispersive",
             .scatters = ThinDielectric(values().varying, true, 9, 0.5f, 0.2f, &values().falling)},
            {.name = "brushed pane",
             .scatters = ThinDielectric(values().glass, false, 0, 0.2f, 0.2f, nullptr, {}, nullptr,
                                        {.strength = 0.7f, .direction = {0.6f, 0.8f}})},
            {.name = "frosted pane under films",
             .scatters = ThinDielectric(values().glass, false, 0, 0.4f, 0.4f, nullptr,
                                        {.share = 0.7f, .eta = 2, .thickness_nm = 300}, &sampled().wavelengths)}};
}

template <>
inline std::vector<Example<MetallicRoughness>> examples() {
    const Values& v = values();
    using M = MetallicRoughness;
    const ThinFilm oil{.share = 1, .eta = 1.4f, .thickness_nm = 400}, oxide{.share = 0.7f, .eta = 2.2f, .thickness_nm = 250};
    return {
        {.name = "metal", .scatters = M(v.rising, {.metallic = 1, .alpha = 0.3f})},
        {.name = "mirror", .scatters = M(v.falling, {.metallic = 1, .alpha = 0})},
        {.name = "mirror under oxide", .scatters = M(v.falling, {.metallic = 1, .alpha = 0, .film = oxide}, nullptr, &sampled())},
        {.name = "plastic", .scatters = M(v.falling, {.alpha = 0.1f})},
        {.name = "plastic with a coloured mirror", .scatters = M(v.falling, {.alpha = 0.3f, .f0 = 0.4f}, &v.rising)},
        {.name = "white clay", .scatters = M(v.white, {.alpha = 0.8f, .f0 = 0.2f})},
        {.name = "blend", .scatters = M(v.rising, {.metallic = 0.4f, .alpha = 0.5f})},
        {.name = "white under a coat", .scatters = M(v.white, {.alpha = 0.6f, .coat = 1, .coat_alpha = 0.1f})},
        {.name = "blend, half coated, nothing at grazing",
         .scatters = M(v.falling, {.metallic = 0.5f, .alpha = 0.4f, .f90 = 0, .coat = 0.5f, .coat_alpha = 0.3f})},
        {.name = "brushed metal", .scatters = M(v.rising, {.metallic = 1, .alpha = 0.1f, .brushing = {0.7f, {0.6f, 0.8f}}})},
        {.name = "brushed plastic under a coat",
         .scatters = M(v.white, {.alpha = 0.3f, .f0 = 0.3f, .coat = 0.5f, .coat_alpha = 0.2f, .brushing = {0.5f, {0, 1}}})},
        {.name = "metal, multiscatter", .scatters = M(v.rising, {.metallic = 1, .alpha = 0.8f, .multiscatter = true})},
        {.name = "coated blend with a coloured mirror, multiscatter",
         .scatters =
             M(v.falling, {.metallic = 0.4f, .alpha = 0.6f, .f0 = 0.4f, .coat = 0.5f, .coat_alpha = 0.1f, .multiscatter = true},
               &v.rising)},
        {.name = "white under oil", .scatters = M(v.white, {.alpha = 0.3f, .film = oil}, nullptr, &sampled())},
        {.name = "white under oxide, smooth", .scatters = M(v.white, {.alpha = 0.04f, .film = oxide}, nullptr, &sampled())},
        {.name = "metal under oxide", .scatters = M(v.rising, {.metallic = 1, .alpha = 0.2f, .film = oxide}, nullptr, &sampled())},
        {.name = "blend under oil and a coat",
         .scatters = M(v.falling, {.metallic = 0.3f, .alpha = 0.5f, .coat = 0.5f, .coat_alpha = 0.1f, .film = oil}, &v.rising,
                       &sampled())}};
}

template <>
inline std::vector<Example<Sheen>> examples() {
    const Values& v = values();
    static const MetallicRoughness cloth(v.falling, {.alpha = 0.8f}), white(v.white, {.alpha = 0.5f, .f0 = 0.2f}),
        metal(v.rising, {.metallic = 1, .alpha = 0.1f, .coat = 0.5f, .coat_alpha = 0.2f}), black(v.black, {.f0 = 0, .f90 = 0});
    static const Sheen::State velvet{cloth, &v.rising, 0.16f}, snow{white, &v.white, 0.64f}, dust{metal, &v.grey, 1},
        fibres{black, &v.white, 0.04f}, none{cloth, &v.black, 0.3f};
    return {{.name = "velvet", .scatters = Sheen(velvet)},
            {.name = "white on white", .scatters = Sheen(snow)},
            {.name = "dusty metal", .scatters = Sheen(dust)},
            {.name = "fibres alone", .scatters = Sheen(fibres)},
            {.name = "none", .scatters = Sheen(none)}};
}

template <>
inline std::vector<Example<DiffuseTransmission>> examples() {
    const Values& v = values();
    return {{.name = "leaf", .scatters = DiffuseTransmission(v.half_rising, v.half_falling)},
            {.name = "lossless", .scatters = DiffuseTransmission(v.half, v.half), .loses_nothing = true},
            {.name = "transmits alone", .scatters = DiffuseTransmission(v.black, v.grey)},
            {.name = "reflects alone", .scatters = DiffuseTransmission(v.grey, v.black)}};
}

// A layer under a coat of index 1.5; `alpha` of the coat.
inline Layer layer_of(float alpha_x, float alpha_y, float thickness) {
    return {.coat = {Microfacets::of_alpha(alpha_x, alpha_y), 1.5f}, .thickness = thickness, .key = 17};
}
inline Layer scattering(Layer layer, const SampledSpectrum& albedo, float g) {
    layer.albedo = &albedo;
    layer.g = g;
    return layer;
}
inline Layer dispersive(Layer layer, std::uint32_t kept) {
    layer.eta = &values().varying;
    layer.coat.eta = values().varying[kept];
    return layer;
}
inline Layer of_any_depth(Layer layer) {
    layer.max_depth = 10'000;
    return layer;
}

template <>
inline std::vector<Example<CoatedDiffuse>> examples() {
    const Values& v = values();
    using State = CoatedDiffuse::State;
    static const State smooth(layer_of(0, 0, 0.1f), Diffuse(v.rising)), lossless(of_any_depth(layer_of(0, 0, 0)), Diffuse(v.white)),
        flint(dispersive(layer_of(0, 0, 0.01f), 5), Diffuse(v.falling)), rough(layer_of(0.3f, 0.3f, 0.01f), Diffuse(v.falling)),
        stretched(layer_of(0.1f, 0.5f, 0.3f), Diffuse(v.grey)),
        rough_flint(dispersive(layer_of(0.3f, 0.3f, 0.01f), 5), Diffuse(v.falling)),
        milk(scattering(layer_of(0, 0, 1), v.falling, 0.4f), Diffuse(v.rising)),
        white_milk(of_any_depth(scattering(layer_of(0, 0, 0.5f), v.white, -0.3f)), Diffuse(v.white)),
        rough_milk(scattering(layer_of(0.4f, 0.4f, 2), v.grey, 0.7f), Diffuse(v.falling)),
        uncoated({.coat = {Microfacets::of_alpha(0, 0), 1}, .thickness = 0.2f, .key = 17}, Diffuse(v.grey));
    return {{.name = "smooth", .scatters = CoatedDiffuse(smooth)},
            {.name = "smooth, lossless", .scatters = CoatedDiffuse(lossless), .loses_nothing = true},
            {.name = "smooth, dispersive", .scatters = CoatedDiffuse(flint)},
            {.name = "alpha 0.3", .scatters = CoatedDiffuse(rough)},
            {.name = "alpha 0.1 x 0.5", .scatters = CoatedDiffuse(stretched)},
            {.name = "alpha 0.3, dispersive", .scatters = CoatedDiffuse(rough_flint), .kept = 5},
            {.name = "scattering", .scatters = CoatedDiffuse(milk)},
            {.name = "scattering, lossless", .scatters = CoatedDiffuse(white_milk), .loses_nothing = true},
            {.name = "alpha 0.4, scattering", .scatters = CoatedDiffuse(rough_milk)},
            {.name = "no interface", .scatters = CoatedDiffuse(uncoated)}};
}

template <>
inline std::vector<Example<CoatedConductor>> examples() {
    const Values& v = values();
    using State = CoatedConductor::State;
    const auto metal = [&](float alpha_x, float alpha_y) { return Conductor(v.eta, v.k, alpha_x, alpha_y); };
    static const State mirror(layer_of(0, 0, 0.01f), metal(0, 0)), flake(layer_of(0, 0, 0.01f), metal(0.3f, 0.3f)),
        brushed(layer_of(0.1f, 0.1f, 0.05f), metal(0.2f, 0.5f)), frosted(layer_of(0.3f, 0.3f, 0.05f), metal(0, 0)),
        flint(dispersive(layer_of(0, 0, 0.01f), 5), metal(0, 0)),
        rough_flint(dispersive(layer_of(0, 0, 0.01f), 5), metal(0.4f, 0.4f)),
        foggy(scattering(layer_of(0, 0, 0.7f), v.falling, 0.2f), metal(0, 0)),
        paint(scattering(layer_of(0.2f, 0.2f, 0.7f), v.falling, 0.2f), metal(0.3f, 0.3f));
    return {{.name = "mirror", .scatters = CoatedConductor(mirror)},
            {.name = "smooth on alpha 0.3", .scatters = CoatedConductor(flake)},
            {.name = "alpha 0.1 on alpha 0.2 x 0.5", .scatters = CoatedConductor(brushed)},
            {.name = "alpha 0.3 on mirror", .scatters = CoatedConductor(frosted)},
            {.name = "dispersive mirror", .scatters = CoatedConductor(flint)},
            {.name = "dispersive on alpha 0.4", .scatters = CoatedConductor(rough_flint), .kept = 5},
            {.name = "scattering on mirror", .scatters = CoatedConductor(foggy)},
            {.name = "all rough, scattering", .scatters = CoatedConductor(paint)}};
}

template <>
inline std::vector<Example<Measured>> examples() {
    static const Wavelengths wavelengths = [] {
        Wavelengths w;
        w.k = kMaxWavelengths;
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) w.lambda_nm[i] = 365 + 14 * static_cast<float>(i);
        return w;
    }();
    const auto tables = [](const MeasuredMetal& metal) {
        return MeasuredTables(std::make_shared<const MeasuredBrdf>(measured(metal)));
    };
    static const MeasuredTables
        metal = tables({.k = 2, .tilt = 0.1f}),
        brushed = tables({.alpha_x = 0.25f, .alpha_y = 0.6f, .k = 2, .tilt = 0.1f, .side = 32, .directions = 6, .turns = 13});
    return {{.name = "alpha 0.4", .scatters = Measured(metal, wavelengths)},
            {.name = "alpha 0.25 x 0.6", .scatters = Measured(brushed, wavelengths)}};
}

// What typed tests run over.
template <class List>
struct TypesOf;
template <class... C>
struct TypesOf<std::variant<C...>> {
    using Closures = ::testing::Types<C...>;
    using WithPhase = ::testing::Types<PhaseFunction, C...>;
};

// A type's name without the namespaces: of Coated<Diffuse> "CoatedDiffuse".
struct NameOf {
    template <class T>
    static std::string GetName(int) {
        std::string name = ::testing::internal::GetTypeName<T>();
        for (const std::string scope = "latent::render::"; name.find(scope) != std::string::npos;)
            name.erase(name.find(scope), scope.size());
        std::erase_if(name, [](char c) { return c == '<' || c == '>'; });
        return name;
    }
};

}  // namespace latent::render::testing
