#include "render/transport/path.h"

#include "render/medium/equiangular.h"
#include "render/transport/scattering.h"
#include "render/transport/transport.h"

namespace latent::render {
namespace {

// Weight of the strategy with density a against one with density b [Veach97 9.2.3].
float power_heuristic(float a, float b) {
    if (!(a < kInfinity)) return 1;
    const float r = b / a;
    return 1 / (1 + r * r);
}

// Light::contrast of what is left to scattering. A sky of which a third shines evenly has this one.
constexpr double kEven = 3;

// One path from the camera, at its last vertex.
class Path {
 public:
    Path(const World& world, SampleState& sample, std::uint32_t max_depth, Radiance& seen)
        : world_(world), lights_(world.lights()), sample_(sample), max_depth_(max_depth), seen_(seen) {}

    void trace(const Camera& camera, Vec2d film) {
        Vec3f origin;
        camera.ray(film.x, film.y, camera.lens_point(sample_.numbers), origin, d_);
        at_ = {origin, 0, {}};
        medium_ = world_.medium_at_start(at_.p, d_, camera.medium(), sample_);
        Scattering scattering;
        for (; find_vertex(scattering) && depth_ < max_depth_; ++depth_) {
            if (!scattering.is_delta()) sample_light(scattering);
            if (!scatter(scattering)) return;
        }
    }

 private:
    Uniform number(std::uint32_t what) const { return sample_.numbers(Dimension::of_camera_vertex(depth_, what)); }
    Uniform number_on(const Segment& segment, std::uint32_t what) const {
        return sample_.numbers(Dimension::behind(segment.index, Dimension::of_camera_vertex(depth_, what)));
    }

    // Follows the ray (at_, d_) to where it scatters next, and gathers what shines on the way. False: nowhere.
    bool find_vertex(Scattering& scattering) {
        transmittance_ = 1;
        const Ray ray = spawn_ray(at_, d_).at_time(sample_.time, seen_directly_);
        const Line line = world_.geometry().trace(ray, Stop::kFirstSolid);
        March march(line, ray, kFar, medium_);
        do {
            const Segment& segment = march.segment();
            medium_ = segment.medium;
            if (medium_ == kNone) continue;
            const Medium& medium = world_.medium(medium_);
            segment_ = segment;
            if (depth_ < max_depth_) sample_point_light(medium);
            SampledSpectrum emitted(0.0f);
            step_ = medium.sample_step(segment, number_on(segment, Dimension::kDistanceChannel),
                                       number_on(segment, Dimension::kDistance), sample_, beta_,
                                       medium.is_emissive() ? &emitted : nullptr);
            if (medium.is_emissive()) seen_.add(emitted, dispersed_, kNone);
            if (step_.scattered) {
                at_ = {segment.o + d_ * step_.t, 0, {}};
                scattering = medium.phase(at_.p, sample_);
                in_tracked_ = medium.is_tracked();
                return true;
            }
            transmittance_ *= step_.density;
        } while (march.next());
        if (!line.hit) {
            for (const std::uint32_t i : lights_.infinite()) see_light(i, {d_, at_.p});
            return false;
        }
        const SurfaceHit& hit = *line.hit;
        if (hit.emitter != kNone) see_light(hit.emitter, {d_, hit.p, hit.ng, hit.on.uv});
        at_ = hit.interaction();
        interface_ = media_at(hit);
        in_tracked_ = false;
        if (depth_ < max_depth_) scattering = world_.bsdf(hit, sample_.spectra, sample_.kept);
        return true;
    }

    // Light that comes from everywhere alike is found by scattering as well as by a sample of it; in a medium that varies in space
    // the way there takes as long.
    bool is_left_to_scattering(const Light& light) const { return in_tracked_ && light.contrast() < kEven; }

    // The ray ends on light i: what that emits, weighed against sample_light, which might have come here too.
    void see_light(std::uint32_t i, const LightHit& hit) {
        const Light& light = lights_[i];
        SampledSpectrum value = beta_;
        if (!light.multiply_emission(hit.point(), -d_, sample_.spectra, value)) return;
        if (!delta_ && !is_left_to_scattering(light)) {
            const float light_pdf = lights_.probability(i, at_.p, context_) * light.pdf_omega(at_.p, context_, hit);
            value *= power_heuristic(pdf_ * transmittance_, light_pdf);
        }
        seen_.add(value, dispersed_, light.id());
    }

    Equiangular equiangular_to(const PointSource& light) const {
        return {segment_.o, d_, segment_.length, light.p, light.axis, light.outer};
    }

    // One vertex more on the segment, for the light of a point alone, chosen by its power P, at a distance drawn evenly in the
    // angle at the light (equiangular). With p the density of the walk's own distances and q the probability of the light in
    // sample_light, the balance heuristic makes f / (P p_E) into f / (q p + P p_E), and so f / (q p) there.
    void sample_point_light(const Medium& medium) {
        if (lights_.size() == 0) return;
        const std::uint32_t i = lights_.choose(number_on(segment_, Dimension::kEquiangularLight)).light;
        const PointSource* source = lights_[i].point_source();
        if (source == nullptr) return;
        const Equiangular equiangular = equiangular_to(*source);
        if (equiangular.is_empty()) return;
        const float t = equiangular.sample(number_on(segment_, Dimension::kEquiangular));
        const Interaction at{segment_.o + d_ * t, 0, {}};
        LightPoint point;
        if (!lights_[i].sample_point(at.p, {}, {}, {}, point)) return;
        SampledSpectrum value = beta_;
        const float walk_pdf = medium.scatter_at(segment_, t, sample_, value).density;
        if (value.is_black()) return;
        LineOfSight line;
        if (!receive(at, medium.phase(at.p, sample_), lights_[i], point, medium_, value, line)) return;
        const float power = lights_.probability(i), place = lights_.probability(i, at.p, {});
        value *= point.falloff / (power * (walk_pdf * (place / power) + equiangular.pdf(t)));
        seen_.add(value, dispersed_, lights_[i].id());
    }

    void sample_light(const Scattering& scattering) {
        if (lights_.size() == 0) return;  // media shine
        const LightSampleContext context = scattering.light_sample_context(-d_);
        const ChosenLight chosen = lights_.choose(number(Dimension::kLightU), at_.p, context);
        if (!(chosen.probability > 0)) return;
        const Light& light = lights_[chosen.light];
        if (is_left_to_scattering(light)) return;
        LightPoint point;
        if (!light.sample_point(at_.p, context, chosen.rest, number(Dimension::kLightV), point)) return;
        const Vec3f wo = -d_;
        const float scattering_pdf = scattering.pdf_omega(wo, point.wi, true);
        if (!(scattering_pdf > 0)) return;
        SampledSpectrum value = beta_;
        const std::uint32_t medium = scattering.in_medium() ? medium_ : interface_.towards(point.wi, at_.ng, medium_);
        LineOfSight line;
        if (!receive(at_, scattering, light, point, medium, value, line)) return;
        const float light_pdf = chosen.probability * point.pdf_omega;
        value *= point.falloff / light_pdf;
        if (const PointSource* source = light.point_source(); source != nullptr && scattering.in_medium()) {
            const float pdf = equiangular_to(*source).pdf(step_.t) * (lights_.probability(chosen.light) / chosen.probability);
            value *= step_.density / (step_.density + pdf);
        }
        if (light.can_be_met()) value *= power_heuristic(light_pdf, scattering_pdf * line.transmittance);
        seen_.add(value, dispersed_ || scattering.disperses(wo, point.wi), light.id());
    }

    // value *= what comes from a point of the light and goes on along -d_. False: nothing does.
    bool receive(const Interaction& at, const Scattering& scattering, const Light& light, const LightPoint& point,
                 std::uint32_t medium, SampledSpectrum& value, LineOfSight& line) {
        scattering.multiply_f_cos(-d_, point.wi, value);
        if (!light.multiply_emission(point.point(), -point.wi, sample_.spectra, value) || value.is_black()) return false;
        return light.is_infinite() ? world_.connect_infinite(at, point.wi, medium, sample_, value, line)
                                   : world_.connect(at, point.at, medium, sample_, value, line);
    }

    // Goes on in a direction of the scattering's own choice. False: absorbed.
    bool scatter(const Scattering& scattering) {
        const Vec3f wo = -d_;
        BsdfSample next;
        if (!scattering.sample(wo, true, number(Dimension::kLobe), number(Dimension::kDirectionU), number(Dimension::kDirectionV),
                               next, beta_)) {
            return false;
        }
        dispersed_ = dispersed_ || scattering.disperses(wo, next.wi);
        context_ = scattering.light_sample_context(wo);
        pdf_ = next.pdf;
        delta_ = next.delta;
        seen_directly_ = seen_directly_ && next.delta;
        eta2_ *= next.eta2;
        d_ = next.wi;
        if (!scattering.in_medium()) medium_ = interface_.towards(d_, at_.ng, medium_);

        const float survival = survival_probability(beta_, eta2_, dispersed_, sample_.kept, scattering.in_medium(), depth_ + 1);
        if (survival <= 0) return false;
        if (depth_ >= 1 && survival < 1) {
            if (number(Dimension::kSurvival) >= survival) return false;
            beta_ *= 1 / survival;
        }
        return true;
    }

    const World& world_;
    const LightSet& lights_;
    SampleState& sample_;
    std::uint32_t max_depth_;
    Radiance& seen_;

    Interaction at_;             // the last vertex
    MediumInterface interface_;  // there, if it is on a surface
    Vec3f d_;                    // from it, or towards the next one
    Segment segment_;            // the last one in a medium
    MediumStep step_;            // along it: to the last vertex, if that is in the medium
    SampledSpectrum beta_{1.0f};
    std::uint32_t medium_ = kNone;
    std::uint32_t depth_ = 0;  // scattering vertices before this one
    bool dispersed_ = false, delta_ = true;
    bool seen_directly_ = true;   // in mirrors or through clear glass, if there are vertices before this one
    bool in_tracked_ = false;     // the last vertex is in a medium that varies in space
    float eta2_ = 1;              // product over all refractions so far
    float pdf_ = 0;               // [1/sr] of d_
    LightSampleContext context_;  // the last vertex, as lights were sampled for it
    float transmittance_ = 1;     // probability of passing the media since the last vertex
};

class PathIntegrator final : public Transport {
 public:
    using Transport::Transport;

 protected:
    void trace_paths(const TracedSample& sample, Vec2d film, bool, Radiance& seen) const override {
        Path(world(), sample.state, settings().max_depth, seen).trace(sample.camera, film);
    }
};

}  // namespace

std::unique_ptr<Integrator> make_path_integrator(std::unique_ptr<World> world, const IntegratorSettings& settings) {
    return std::make_unique<PathIntegrator>(std::move(world), settings);
}

}  // namespace latent::render
