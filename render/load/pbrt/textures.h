// render/load/pbrt/textures.h: Texture directives, and the parameters of others that may be textures. Defaults are pbrt-v4's.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "render/load/files/scene_files.h"
#include "render/load/pbrt/names.h"
#include "render/load/pbrt/parameters.h"
#include "render/load/pbrt/spectra.h"
#include "render/load/pbrt/transforms.h"
#include "render/scene/description.h"

namespace latent::render {

// Errors and warnings go to the diagnostics; what is returned is then of no use, but valid.
class SceneTextures {
 public:
    // All of these outlive it.
    SceneTextures(SceneDescription& scene, SceneFiles& files, SceneSpectra& spectra, Diagnostics& diagnostics)
        : scene_(scene), files_(files), spectra_(spectra), diagnostics_(diagnostics) {}

    // A Texture directive with what the graphics state adds to it. Only textures that something uses come into the scene.
    void define(const Directive& directive, const std::vector<Parameter>& inherited, const CurrentTransform& ctm,
                const std::string& color_space);

    // The parameter `name`, a value or a texture; the default, if it is not there. Values are checked against low..high.
    FloatInput number(const ParameterList& list, std::string_view name, double otherwise, double low = -1e30, double high = 1e30);
    SpectrumInput spectrum(const ParameterList& list, std::string_view name, SpectrumRole role, const color::Spectrum& otherwise);
    // Nothing if it is not there.
    std::optional<SpectrumInput> find_spectrum(const ParameterList& list, std::string_view name, SpectrumRole role);
    std::optional<color::Spectrum> find_value(const ParameterList& list, std::string_view name, SpectrumRole role) {
        return spectra_.find(list, name, role);  // where pbrt takes no texture
    }
    // The spectrum of linear sRGB of any magnitude.
    color::Spectrum unbounded(const std::array<double, 3>& rgb) { return spectra_.unbounded(rgb); }
    std::uint32_t normal_map(const ParameterList& list);  // the parameter "normalmap"; kNone if it is missing
    // A picture over the uv of a shape, of any magnitude.
    std::uint32_t emission(const ParameterList& list, const std::string& file);
    std::optional<std::uint32_t> find_texture(const ParameterList& list, std::string_view name);  // a texture of numbers

    // After the last directive: reads the textures that were used, and what they use. Adds those that are not defined.
    void finish(std::vector<UndefinedName>& undefined);

 private:
    struct Definition {
        Directive directive;
        std::vector<Parameter> inherited;
        CurrentTransform ctm;
        std::string color_space;
    };
    struct Use {
        bool is_spectrum;
        SpectrumRole role;
        std::string name;
        SourceLocation where;                         // first
        std::optional<TextureDescription> picture{};  // not by name
    };
    std::uint32_t use_picture(const ParameterList& list, const std::string& file, TextureDescription texture);
    std::uint32_t use(const ParameterList& list, const Parameter& p, bool is_spectrum, SpectrumRole role);
    TextureDescription read(const Definition& definition, const Use& use);
    void read_mapping(const ParameterList& list, const CurrentTransform& ctm, bool is_solid, MappingDescription& mapping);
    std::string name_of(const ParameterList& list, const PictureDescription& picture) const;  // in messages
    void read_picture(const ParameterList& list, PictureDescription& picture);

    SceneDescription& scene_;
    SceneFiles& files_;
    SceneSpectra& spectra_;
    Diagnostics& diagnostics_;
    std::map<std::pair<bool, std::string>, Definition> definitions_;             // by is_spectrum and name
    std::map<std::tuple<bool, SpectrumRole, std::string>, std::uint32_t> used_;  // index into SceneDescription::textures
    std::deque<Use> uses_;                                                       // how each of these is used
};

}  // namespace latent::render
