#include "render/light/rgb_illuminant.h"

#include <array>
#include <utility>

#include "color/named_spectra.h"
#include "color/rgb_to_spectrum.h"

namespace latent::render {

RgbIlluminant::RgbIlluminant(SpectrumLibrary& library, color::RgbSpectra kind) : is_basis_(kind == color::RgbSpectra::kBasis) {
    if (is_basis_) {
        for (std::size_t c = 0; c < 3; ++c) basis_[c] = library.add(color::rgb_basis()[c], Lookup::kLinear);
        return;
    }
    const color::RgbToSpectrum to_spectrum(color::RgbSpace::srgb(), color::illuminant_d65());
    const color::Rgb colours[6] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 0}};
    for (int c = 0; c < 6; ++c) {
        const color::SigmoidSpectrum sigmoid = to_spectrum.reflectance(colours[c]);
        const auto value = [&](double nm) { return sigmoid(static_cast<float>(nm)); };
        basis_[c] = library.add(color::Spectrum::from_function(value, color::Outside::kClamped), Lookup::kLinear);
    }
}

void RgbIlluminant::multiply(const float* rgb, SampledSpectra& spectra, SampledSpectrum& value) const {
    if (is_basis_) {
        const SampledSpectrum &r = spectra[basis_[0]], &g = spectra[basis_[1]], &b = spectra[basis_[2]];
        for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) value.v[i] *= rgb[0] * r.v[i] + rgb[1] * g.v[i] + rgb[2] * b.v[i];
        return;
    }
    std::array<int, 3> order = {0, 1, 2};  // by falling value
    if (rgb[order[0]] < rgb[order[1]]) std::swap(order[0], order[1]);
    if (rgb[order[1]] < rgb[order[2]]) std::swap(order[1], order[2]);
    if (rgb[order[0]] < rgb[order[1]]) std::swap(order[0], order[1]);
    const float white = rgb[order[2]], secondary = rgb[order[1]] - white, primary = rgb[order[0]] - rgb[order[1]];
    const SampledSpectrum& first = spectra[basis_[order[0]]];
    const SampledSpectrum& second = spectra[basis_[3 + order[2]]];  // the complement of the smallest component
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) value.v[i] *= white + secondary * second.v[i] + primary * first.v[i];
}

}  // namespace latent::render
