// The lights of a scene description, their scales resolved and their powers weighed.
#include "color/light_spectrum.h"
#include "color/visible_density.h"
#include "render/light/environment.h"
#include "render/light/lights.h"

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

Lights Lights::build(const SceneDescription& scene, const Geometry& geometry, const Vec3f& center, float radius,
                     SpectrumLibrary& library) {
    Lights lights;
    lights.center_ = center;
    lights.radius_ = radius;
    std::vector<double> power;  // weighed by choice_weight, of each light
    const double disk = std::numbers::pi * static_cast<double>(radius) * static_cast<double>(radius);

    // What lights of one spectrum have in common: a mesh may be a million lights.
    struct Spectral {
        std::uint32_t table;     // of the library
        std::size_t of_density;  // index into spectra_
        double power, luminance;
    };
    const auto spectral = [&](const color::Spectrum& spectrum) -> Spectral {
        lights.spectra_.push_back({spectrum, 0});
        return {library.add(spectrum, Lookup::kNearestNm), lights.spectra_.size() - 1,
                integral_of_product(spectrum, choice_weight()), luminance(spectrum)};
    };
    const auto add = [&](Light light, const Spectral& s, double extent) {
        light.spectrum = s.table;
        const double size = static_cast<double>(light.scale) * extent;
        power.push_back(size * s.power);
        lights.spectra_[s.of_density].luminous_power += size * s.luminance;
        if (light.is_infinite()) lights.infinite_.push_back(static_cast<std::uint32_t>(lights.lights_.size()));
        lights.lights_.push_back(light);
    };

    std::vector<std::optional<Spectral>> of_area(scene.area_lights.size());
    for (const Emitter& e : geometry.emitters()) {
        const AreaLightDescription& area = scene.area_lights[e.area_light];
        if (!of_area[e.area_light]) of_area[e.area_light] = spectral(area.spectrum);
        Light light;
        light.kind = e.is_sphere ? Light::Kind::kSphere : Light::Kind::kTriangle;
        light.scale = e.scale;
        light.two_sided = area.two_sided;
        light.inside_medium = e.inside_medium;
        light.outside_medium = e.outside_medium;
        light.p = e.p;
        light.e1 = e.e1;
        light.e2 = e.e2;
        light.n = e.n;
        light.radius = e.radius;
        light.inward = e.inward;
        light.area = e.area;
        add(light, *of_area[e.area_light], std::numbers::pi * static_cast<double>(e.area) * (area.two_sided ? 2 : 1));
    }
    for (const LightDescription& d : scene.lights) {
        Light light;
        light.outside_medium = d.medium;
        const Vec3d from = d.world_from_light.point(d.from), to = d.world_from_light.point(d.to);
        double scale = d.scale;
        switch (d.kind) {
            case LightKind::kPoint:
                light.kind = Light::Kind::kPoint;
                light.p = Vec3f(from);
                if (d.power) scale *= *d.power / (4 * std::numbers::pi);
                light.scale = static_cast<float>(scale);
                add(light, spectral(d.spectrum), 4 * std::numbers::pi);
                break;
            case LightKind::kSpot: {
                light.kind = Light::Kind::kSpot;
                light.p = Vec3f(from);
                light.n = Vec3f(normalize(to - from));
                const auto one_minus_cos = [](double degrees) {
                    const double s = std::sin(degrees * std::numbers::pi / 360);
                    return 2 * s * s;
                };
                const double outer = one_minus_cos(d.cone_degrees), inner = one_minus_cos(d.cone_degrees - d.cone_delta_degrees);
                light.outer = static_cast<float>(outer);
                light.inner = static_cast<float>(inner);
                const double solid_angle = std::numbers::pi * (inner + outer);  // the smooth step counts half
                if (d.power) scale *= *d.power / solid_angle;
                light.scale = static_cast<float>(scale);
                add(light, spectral(d.spectrum), solid_angle);
                break;
            }
            case LightKind::kDistant:
                light.kind = Light::Kind::kDistant;
                light.n = Vec3f(normalize(from - to));
                if (d.illuminance) scale *= *d.illuminance;
                light.scale = static_cast<float>(scale);
                add(light, spectral(d.spectrum), disk);
                break;
            case LightKind::kInfinite:
                // Of 4 pi L that crosses each square metre of the scene, a surface receives pi L at most.
                if (d.image) {
                    light.kind = Light::Kind::kImage;
                    lights.environments_.push_back(std::make_unique<Environment>(d.image, d.world_from_light, library));
                    light.environment = lights.environments_.back().get();
                    if (d.illuminance) scale *= *d.illuminance / light.environment->upper_illuminance();
                    light.scale = static_cast<float>(scale);
                    add(light, spectral(d.spectrum), std::numbers::pi * disk * light.environment->mean_luminance());
                } else {
                    light.kind = Light::Kind::kConstant;
                    if (d.illuminance) scale *= *d.illuminance / std::numbers::pi;
                    light.scale = static_cast<float>(scale);
                    add(light, spectral(d.spectrum), std::numbers::pi * disk);
                }
                break;
        }
    }

    // The sky has half of the choices where there are local lights too.
    double sums[2] = {0, 0};
    for (std::size_t i = 0; i < power.size(); ++i) sums[lights.lights_[i].is_infinite()] += power[i];
    for (std::size_t i = 0; i < power.size(); ++i) power[i] /= std::max(sums[lights.lights_[i].is_infinite()], 1e-300);
    if (sums[0] + sums[1] > 0) {
        lights.choice_ = Choice(power);
    } else if (!power.empty()) {
        lights.choice_ = Choice(std::vector<double>(power.size(), 1));  // all of them black: any will do
    }
    return lights;
}

}  // namespace latent::render
