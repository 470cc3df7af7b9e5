#include "render/light/light_set.h"

#include "color/light_spectrum.h"
#include "color/visible_density.h"

namespace latent::render {
namespace {

// 0.9 p_eye + 0.1 uniform: what a light's power is weighed with when lights are chosen.
const color::Spectrum& choice_weight() {
    static const color::Spectrum weight = color::Spectrum::from_function(
        [](double nm) { return 0.9 * color::visible_pdf_lambda(nm) + 0.1 / (color::kLambdaMax - color::kLambdaMin); },
        color::Outside::kZero);
    return weight;
}

}  // namespace

LightSet::LightSet(const SceneDescription& scene, const Geometry& geometry, const Textures& textures, const SceneBall& ball,
                   SpectrumLibrary& library) {
    // The lights of one source in the scene share its spectrum: a mesh may be a million lights.
    struct Source {
        std::uint32_t id, spectrum;  // number of the source, and of its spectrum in the library
        std::size_t of_density;      // index into spectra_
        double weighed, luminance;   // integrals of the spectrum
    };
    const auto source = [&](std::size_t id, const color::Spectrum& spectrum) -> Source {
        spectra_.push_back({spectrum, 0});
        return {static_cast<std::uint32_t>(id), library.add(spectrum, Lookup::kNearestNm), spectra_.size() - 1,
                integral_of_product(spectrum, choice_weight()), luminance(spectrum)};
    };
    std::vector<double> power;  // each light's, weighed
    const auto add = [&](const Source& s, const auto& type, bool is_hidden = false) {
        const Light light(s.id, type, is_hidden);
        const double size = static_cast<double>(light.emission().scale) * light.extent();
        power.push_back(size * s.weighed);
        spectra_[s.of_density].luminous_power += size * s.luminance;
        if (light.is_infinite() && !light.is_delta()) infinite_.push_back(static_cast<std::uint32_t>(lights_.size()));
        lights_.push_back(light);
    };

    std::vector<std::optional<Source>> of_area(scene.area_lights.size());
    for (const Emitter& e : geometry.emitters()) {
        const AreaLightDescription& d = scene.area_lights[e.area_light];
        std::optional<Source>& s = of_area[e.area_light];
        if (!s) s = source(e.area_light, d.spectrum);
        const ShapeDescription& shape = scene.shapes[e.shape];
        const bool is_hidden = is_nowhere(shape.alpha);
        if (e.primitive == 0 && (d.picture != kNone || shape.alpha.is_textured() || (shape.alpha.value < 1 && !is_hidden))) {
            EmissionPattern pattern{
                .geometry = &geometry, .shape = e.shape, .alpha = is_hidden ? FloatSource{1} : textures.source(shape.alpha)};
            if (d.picture != kNone) pattern.picture = textures.spectrum(d.picture);
            patterns_.push_back(std::make_unique<EmissionPattern>(pattern));
        }
        const bool varies = !patterns_.empty() && patterns_.back()->shape == e.shape;
        const AreaEmission area(d, s->spectrum, e, varies ? patterns_.back().get() : nullptr);
        switch (e.kind) {
            case EmitterKind::kTriangle:
                add(*s, TriangleLight(e, area), is_hidden);
                break;
            case EmitterKind::kSphere:
                add(*s, SphereLight(e, area), is_hidden);
                break;
            case EmitterKind::kQuadric:
                quadrics_.push_back(std::make_unique<ShapeDescription>(shape));
                add(*s, QuadricLight(*quadrics_.back(), area), is_hidden);
                break;
        }
        if (shape.backdrop) power.back() = 0;
    }
    for (const LightDescription& d : scene.lights) {
        const Source s = source(scene.area_lights.size() + static_cast<std::size_t>(&d - scene.lights.data()), d.spectrum);
        switch (d.kind) {
            case LightKind::kPoint:
                add(s, PointLight(d, s.spectrum));
                break;
            case LightKind::kSpot:
                add(s, SpotLight(d, s.spectrum));
                break;
            case LightKind::kGoniometric: {
                // pbrt-v4 exchanges y and z of light space.
                const Affined& m = d.world_from_light;
                maps_.push_back(std::make_unique<EnvironmentMap>(d.image, Affined(m.x, m.z, m.y, m.t), library, scene.rgb_spectra));
                add(s, GoniometricLight(d, *maps_.back(), s.spectrum));
                break;
            }
            case LightKind::kProjection:
                projections_.push_back(
                    std::make_unique<ProjectionMap>(d.image, d.world_from_light, d.fov_degrees, library, scene.rgb_spectra));
                add(s, ProjectionLight(d, *projections_.back(), s.spectrum));
                break;
            case LightKind::kDistant:
                add(s, DistantLight(d, s.spectrum, ball));
                break;
            case LightKind::kInfinite:
                if (d.image)
                    maps_.push_back(std::make_unique<EnvironmentMap>(d.image, d.world_from_light, library, scene.rgb_spectra));
                if (d.portal) {
                    portals_.push_back(std::make_unique<Portal>(*d.portal));
                    const EnvironmentMap* map = d.image ? maps_.back().get() : nullptr;
                    add(s, PortalLight(d, *portals_.back(), map, s.spectrum, ball));
                } else if (d.image) {
                    add(s, ImageInfiniteLight(d, *maps_.back(), s.spectrum, ball));
                } else {
                    add(s, UniformInfiniteLight(d, s.spectrum, ball));
                }
                break;
        }
    }

    double sums[2] = {0, 0};  // for local and for infinite lights, which share the choices evenly
    for (std::size_t i = 0; i < power.size(); ++i) sums[lights_[i].is_infinite()] += power[i];
    for (std::size_t i = 0; i < power.size(); ++i) power[i] /= std::max(sums[lights_[i].is_infinite()], 1e-300);
    if (sums[0] + sums[1] > 0) {
        table_ = AliasTable(power);
    } else if (!power.empty()) {
        table_ = AliasTable(std::vector<double>(power.size(), 1));  // all of them black: any will do
    }
    plant(geometry.emitters(), power);
}

// `power`: each light's share of that of its kind. What stays of it is that of infinite lights.
void LightSet::plant(const std::vector<Emitter>& emitters, std::vector<double>& power) {
    std::vector<LightBounds> bounds(lights_.size());
    std::vector<std::uint32_t> local;
    bool sky = false;
    for (std::uint32_t i = 0; i < lights_.size(); ++i) {
        if (!(power[i] > 0)) continue;
        sky |= lights_[i].is_infinite();
        if (lights_[i].is_infinite()) continue;
        local.push_back(i);
        bounds[i] = lights_[i].bounds();
        bounds[i].intensity = power[i] * bounds[i].concentration;
        power[i] = 0;
    }
    const bool pair = local.size() == 2 && local[1] < emitters.size() && emitters[local[0]].shape == emitters[local[1]].shape;
    if (local.size() < 2 || pair) return;
    tree_ = LightTree(bounds);
    if (sky) infinite_table_ = AliasTable(power);
}

ChosenLight LightSet::choose_by_place(Uniform u, const Vec3f& p, const LightSampleContext& context) const {
    if (infinite_table_.size() == 0) return tree_.choose(u, p, context);
    const bool lit = tree_.reaches(p, context);
    if (lit && u.index(2) == 0) {
        ChosenLight chosen = tree_.choose(u.within(2), p, context);
        chosen.probability *= 0.5f;
        return chosen;
    }
    ChosenLight chosen;
    chosen.light = infinite_table_.sample(lit ? u.within(2) : u, chosen.rest);
    chosen.probability = (lit ? 0.5f : 1) * infinite_table_.probability(chosen.light);
    return chosen;
}

float LightSet::probability_by_place(std::uint32_t i, const Vec3f& p, const LightSampleContext& context) const {
    if (infinite_table_.size() == 0) return tree_.probability(i, p, context);
    if (!lights_[i].is_infinite()) return 0.5f * tree_.probability(i, p, context);
    return (tree_.reaches(p, context) ? 0.5f : 1) * infinite_table_.probability(i);
}

}  // namespace latent::render
