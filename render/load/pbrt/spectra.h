// render/load/pbrt/spectra.h: spectra as scenes write them: rgb, inline samples, names, files, black bodies.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>

#include "color/rgb_basis.h"
#include "color/rgb_to_spectrum.h"
#include "color/spectrum.h"
#include "render/load/files/scene_files.h"
#include "render/load/pbrt/parameters.h"
#include "render/scene/texture.h"

namespace latent::render {

class SceneSpectra {
 public:
    SceneSpectra(SceneFiles& files, color::RgbSpectra kind) : files_(files), kind_(kind) {}

    // The colour space that rgb parameters are in: pbrt's "srgb", "dci-p3", "rec2020" or "aces2065-1". False if there is no such
    // space.
    bool set_color_space(const std::string& name);

    // Whether a spectrum of this name is there, of any type.
    static bool is_given(const ParameterList& list, std::string_view name) { return parameter(list, name) != nullptr; }
    // The spectrum of a parameter; nothing if it is not there or an error was reported.
    std::optional<color::Spectrum> find(const ParameterList& list, std::string_view name, SpectrumRole role);
    // An emission, normalised as AreaLightDescription says; the colour space's white if the parameter is not there.
    color::Spectrum emission(const ParameterList& list, std::string_view name);
    color::Spectrum white();                     // normalised illuminant of the colour space
    static color::Spectrum white_of_pictures();  // the same of sRGB, which pictures are brought into
    // The spectrum of an rgb in the colour space.
    color::Spectrum spectrum_of(const color::Rgb& rgb, SpectrumRole role);
    // The same for voxels: what SpectralVoxels holds.
    bool is_basis() const { return kind_ == color::RgbSpectra::kBasis; }
    std::array<float, 4> voxel_of(const color::Rgb& rgb);
    // The spectrum of linear sRGB of any magnitude.
    color::Spectrum unbounded(const std::array<double, 3>& rgb);

 private:
    const color::RgbToSpectrum& rgb();
    color::Rgb to_srgb(const color::Rgb& rgb) const;
    static const Parameter* parameter(const ParameterList& list, std::string_view name) {
        return list.find(name, {"rgb", "spectrum", "blackbody", "latent:daylight"});
    }
    std::optional<color::Spectrum> resolve(const ParameterList& list, const Parameter& p, SpectrumRole role);
    std::optional<color::Spectrum> from_pairs(const ParameterList& list, const Parameter& p, std::span<const double> pairs);
    std::optional<color::Spectrum> from_file(const ParameterList& list, const Parameter& p);

    SceneFiles& files_;
    color::RgbSpectra kind_;
    std::string color_space_ = "srgb";
    std::map<std::string, color::RgbToSpectrum> rgb_;
};

}  // namespace latent::render
