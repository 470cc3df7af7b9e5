#include "render/load/pbrt/measured_media.h"

#include <algorithm>

#include "color/named_spectra.h"
#include "color/rgb_to_spectrum.h"

namespace latent::render {

namespace {

struct Entry {
    std::string_view name;
    color::Rgb sigma_s, sigma_a;
};
constexpr Entry kMeasured[] = {
    {"Apple", {2.29, 2.39, 1.97}, {0.0030, 0.0034, 0.046}}, {"Chicken1", {0.15, 0.21, 0.38}, {0.015, 0.077, 0.19}},
    {"Chicken2", {0.19, 0.25, 0.32}, {0.018, 0.088, 0.20}}, {"Cream", {7.38, 5.47, 3.15}, {0.0002, 0.0028, 0.0163}},
    {"Ketchup", {0.18, 0.07, 0.03}, {0.061, 0.97, 1.45}},   {"Marble", {2.19, 2.62, 3.00}, {0.0021, 0.0041, 0.0071}},
    {"Potato", {0.68, 0.70, 0.55}, {0.0024, 0.0090, 0.12}}, {"Skimmilk", {0.70, 1.22, 1.90}, {0.0014, 0.0025, 0.0142}},
    {"Skin1", {0.74, 0.88, 1.01}, {0.032, 0.17, 0.48}},     {"Skin2", {1.09, 1.59, 1.79}, {0.013, 0.070, 0.145}},
    {"Spectralon", {11.6, 20.4, 14.9}, {0.00, 0.00, 0.00}}, {"Wholemilk", {2.55, 3.21, 3.77}, {0.0011, 0.0024, 0.014}},
};

}  // namespace

std::optional<MeasuredMedium> measured_medium(std::string_view name) {
    const Entry* const found = std::ranges::find(kMeasured, name, &Entry::name);
    if (found == std::end(kMeasured)) return std::nullopt;
    const color::RgbToSpectrum to_spectrum(color::RgbSpace::srgb(), color::illuminant_d65());
    const auto spectrum = [&](const color::Rgb& rgb) {
        if (rgb.r == 0 && rgb.g == 0 && rgb.b == 0) return color::Spectrum::constant(0);
        return color::Spectrum::from_function([s = to_spectrum.unbounded(rgb)](double nm) { return s(static_cast<float>(nm)); },
                                              color::Outside::kClamped);
    };
    return MeasuredMedium{spectrum(found->sigma_a), spectrum(found->sigma_s)};
}

std::string measured_media() {
    std::string names;
    for (const Entry& entry : kMeasured) names += (names.empty() ? "" : ", ") + std::string(entry.name);
    return names;
}

}  // namespace latent::render
