// render/light/light.h: the list of lights, and a light of the scene: one of them with the verbs of all (light_type.h).
#pragma once

#include <variant>

#include "render/light/distant_light.h"
#include "render/light/image_infinite_light.h"
#include "render/light/mapped_point_light.h"
#include "render/light/point_light.h"
#include "render/light/portal_light.h"
#include "render/light/quadric_light.h"
#include "render/light/sphere_light.h"
#include "render/light/spot_light.h"
#include "render/light/triangle_light.h"
#include "render/light/uniform_infinite_light.h"

namespace latent::render {

template <LightType... L>
using LightList = std::variant<L...>;

using AnyLight = LightList<  //
    TriangleLight,           //
    SphereLight,             //
    QuadricLight,            //
    PointLight,              //
    SpotLight,               //
    GoniometricLight,        //
    ProjectionLight,         //
    DistantLight,            //
    UniformInfiniteLight,    //
    ImageInfiniteLight,      //
    PortalLight>;

class Light {
    template <class F>
    decltype(auto) visit(F f) const {
        return std::visit(f, light_);
    }

 public:
    // `id`: of the light as the scene gives it, which may be many of these.
    template <LightType L>
    Light(std::uint32_t id, const L& light, bool is_hidden = false)
        : id_(id), infinite_(L::kIsInfinite), delta_(L::kIsDelta), hidden_(is_hidden), light_(light) {
        if constexpr (requires { light.contrast(); }) contrast_ = light.contrast();
    }

    // Every triangle of a mesh has the id of its area light: index into SceneDescription::area_lights, or their number plus the
    // index into SceneDescription::lights.
    std::uint32_t id() const { return id_; }
    bool is_infinite() const { return infinite_; }
    bool is_delta() const { return delta_; }
    bool has_area() const { return !infinite_ && !delta_; }
    // Whether rays can run into it: not a point, a single direction, nor a surface that is nowhere.
    bool can_be_met() const { return !delta_ && !hidden_; }
    const PointSource* point_source() const {  // for a light that is a point; else null
        return visit([](const auto& light) -> const PointSource* {
            if constexpr (requires { light.source(); }) {
                return &light.source();
            } else {
                return nullptr;
            }
        });
    }

    // Whether light comes to p from unit w, where nothing is in the way: not to the back of a portal.
    bool reaches(const Vec3f& p, const Vec3f& w) const {
        return visit([&](const auto& light) {
            if constexpr (requires { light.reaches(p, w); }) {
                return light.reaches(p, w);
            } else {
                return true;
            }
        });
    }

    // The mean square of radiance over all directions, over its squared mean. Infinity unless it comes from all directions.
    double contrast() const { return contrast_; }

    const Emission& emission() const {
        return visit([](const auto& light) -> const Emission& { return light.emission(); });
    }
    double extent() const {
        return visit([](const auto& light) { return light.extent(); });
    }
    // Not of an infinite light.
    LightBounds bounds() const {
        return visit([](const auto& light) {
            if constexpr (requires { light.bounds(); }) {
                return light.bounds();
            } else {
                return LightBounds{};
            }
        });
    }
    bool sample_point(const Vec3f& from, const LightSampleContext& context, Uniform u, Uniform v, LightPoint& out) const {
        return visit([&](const auto& light) { return light.sample_point(from, context, u, v, out); });
    }
    float pdf_omega(const Vec3f& from, const LightSampleContext& context, const LightHit& hit) const {
        return visit([&](const auto& light) { return light.pdf_omega(from, context, hit); });
    }
    void sample_ray(Uniform u, Uniform v, Uniform s, Uniform t, LightRay& out) const {
        visit([&](const auto& light) { light.sample_ray(u, v, s, t, out); });
    }
    float pdf_position() const {
        return visit([](const auto& light) { return light.pdf_position(); });
    }
    float pdf_direction(const Vec3f& ng, const Vec3f& d) const {
        return visit([&](const auto& light) { return light.pdf_direction(ng, d); });
    }
    bool multiply_emission(const EmissionPoint& at, const Vec3f& d, SampledSpectra& spectra, SampledSpectrum& value) const {
        return visit([&](const auto& light) { return light.multiply_emission(at, d, spectra, value); });
    }

 private:
    std::uint32_t id_;
    bool infinite_, delta_, hidden_;
    double contrast_ = kInfinity;
    AnyLight light_;
};

}  // namespace latent::render
