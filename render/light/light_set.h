// render/light/light_set.h: the lights of a scene, and how one of them is chosen. docs/rendering.md, "Lights".
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "render/light/light.h"
#include "render/light/light_tree.h"
#include "render/sampling/alias_table.h"
#include "render/scene/description.h"
#include "render/spectral/wavelength_density.h"
#include "render/texture/textures.h"

namespace latent::render {

// Does not change once built: any thread.
class LightSet {
 public:
    // Geometry and textures outlive it.
    LightSet(const SceneDescription& scene, const Geometry& geometry, const Textures& textures, const SceneBall& ball,
             SpectrumLibrary& library);

    std::size_t size() const { return lights_.size(); }
    const Light& operator[](std::uint32_t i) const { return lights_[i]; }  // emitter i of the geometry is light i
    // Those that rays run into when they leave the scene: not the ones of a single direction.
    const std::vector<std::uint32_t>& infinite() const { return infinite_; }
    const std::vector<LightSpectrum>& spectra() const { return spectra_; }  // for the wavelength density

    // For light that goes anywhere: lights are chosen by their power, weighed by wavelength as 0.9 p_eye + 0.1 uniform, so that no
    // light is never chosen; infinite lights have half of the choices where there are others too.
    ChosenLight choose(Uniform u) const {
        ChosenLight chosen;
        chosen.light = table_.sample(u, chosen.rest);
        chosen.probability = table_.probability(chosen.light);
        return chosen;
    }
    float probability(std::uint32_t i) const { return table_.probability(i); }

    // For point p. Where there is a tree, lights that are not infinite are chosen by it; infinite ones have half of the choices, or
    // all where no other light can shine. Scenes have one unless one lamp is all that they have besides: a light, or a shape of two
    // triangles. They choose as above.
    bool has_tree() const { return !tree_.is_empty(); }
    ChosenLight choose(Uniform u, const Vec3f& p, const LightSampleContext& context) const {
        return has_tree() ? choose_by_place(u, p, context) : choose(u);
    }
    float probability(std::uint32_t i, const Vec3f& p, const LightSampleContext& context) const {
        return has_tree() ? probability_by_place(i, p, context) : probability(i);
    }

 private:
    void plant(const std::vector<Emitter>& emitters, std::vector<double>& power);
    ChosenLight choose_by_place(Uniform u, const Vec3f& p, const LightSampleContext& context) const;
    float probability_by_place(std::uint32_t i, const Vec3f& p, const LightSampleContext& context) const;

    std::vector<Light> lights_;
    std::vector<std::uint32_t> infinite_;
    std::vector<LightSpectrum> spectra_;
    // That lights point to.
    std::vector<std::unique_ptr<const EnvironmentMap>> maps_;
    std::vector<std::unique_ptr<const ProjectionMap>> projections_;
    std::vector<std::unique_ptr<const Portal>> portals_;
    std::vector<std::unique_ptr<const ShapeDescription>> quadrics_;
    std::vector<std::unique_ptr<const EmissionPattern>> patterns_;
    AliasTable table_;
    LightTree tree_;             // holds those that are not infinite
    AliasTable infinite_table_;  // beside the tree: no other light has a probability; empty: no infinite light shines
};

}  // namespace latent::render
