// Bidirectional path tracing: a subpath from the eye and one from a light, joined in every way. docs/rendering.md, "Bidirectional".
#include "render/bdpt.h"

namespace latent::render {
namespace {

using Subpath = std::vector<SubpathVertex>;

// A step of a subpath, from its last vertex in unit direction d.
struct Step {
    Vec3f d;
    float pdf = 0;  // [1/sr]; of parallel rays [1/m^2] across them
    bool parallel = false;
    float before = 0;  // of the vertex that it will reach
    std::uint32_t medium = kNone;
    bool dispersed = false;
    Batch beta;
    Batch through{1.0f};  // throughput of the subpath, for its odds of going on
};

// One sample: two subpaths and what joining them gives.
class Bidirectional {
 public:
    Bidirectional(const World& world, const IntegratorSettings& settings, const RecordMaker& records, SampleState& sample,
                  Subpath& eye, Subpath& light, const StrategyFault& fault, Radiance& camera, sampledb::Records& out,
                  RadianceFaults& faults)
        : world_(world),
          lights_(world.lights()),
          all_(settings.connections == Connections::kAll),
          most_(settings.max_depth == kUnlimited ? kUnlimited : settings.max_depth + 2),
          records_(records),
          sample_(sample),
          eye_(eye),
          light_(light),
          fault_(fault),
          camera_(camera),
          out_(out),
          faults_(faults) {}

    void trace(double u, double v) {
        trace_light();
        trace_eye(u, v);
        for (std::size_t i = 1; i < light_.size(); ++i) join_lens(i);
        for (std::size_t i = 1; i < eye_.size(); ++i) join_light(i);
        if (all_) {
            for (std::size_t i = 1; i < light_.size(); ++i) {
                for (std::size_t j = 1; j < eye_.size() && i + j + 2 <= most_; ++j) join(i, j, 1);
            }
        } else {
            join_one_of_each_length();
        }
    }

 private:
    float eye_number(std::size_t vertex, std::uint32_t what) const {
        return sample_.numbers(Dimension::of_camera_vertex(static_cast<std::uint32_t>(vertex), what));
    }
    float light_number(std::size_t vertex, std::uint32_t what) const {
        return sample_.numbers(Dimension::of_light_vertex(static_cast<std::uint32_t>(vertex), what));
    }
    // Numbers of the step that leads to vertex i, and of scattering there.
    float number(bool from_eye, std::size_t i, std::uint32_t what) const {
        return from_eye ? eye_number(i - 1, what) : light_number(i, what);
    }

    // Of strategy (s, t), `others` the sum of (p_j / p)^2 over the other strategies.
    float weight(std::size_t s, std::size_t t, float others) const {
        return (s == fault_.s && t == fault_.t ? fault_.factor : 1) / (1 + others);
    }

    void trace_eye(double u, double v) {
        const Camera& camera = world_.camera();
        const bool lens = camera.has_lens();
        eye_.resize(1);
        SubpathVertex& x = eye_[0];
        Step step;
        Vec3f origin;
        camera.ray(u, v, lens ? sample_.numbers(Dimension::kLensU) : 0, lens ? sample_.numbers(Dimension::kLensV) : 0, origin,
                   step.d);
        x = {};
        x.at = {origin, 0, {}};
        x.normal = camera.axis();
        x.forward = lens ? 1 / camera.lens_area() : 1;
        x.open = lens ? 1 : 0;
        step.pdf = camera.jacobian(step.d);
        step.parallel = camera.parallel();
        step.before = x.open;
        step.medium = camera.medium();
        step.beta = Batch(1.0f);
        walk(eye_, true, step);
    }

    void trace_light() {
        chosen_ = lights_.choose(light_number(0, Dimension::kLight));
        const Light& light = lights_[chosen_];
        LightRay ray;
        lights_.sample_ray(chosen_, light_number(0, Dimension::kLightU), light_number(0, Dimension::kLightV),
                           light_number(0, Dimension::kDirectionU), light_number(0, Dimension::kDirectionV), ray);
        const float odds = lights_.probability(chosen_);
        light_.resize(1);
        SubpathVertex& x = light_[0];
        x = {};
        x.at = ray.anchor;
        x.normal = ray.anchor.ng;
        x.forward = odds * (light.is_infinite() ? ray.pdf_direction : ray.pdf_position);
        x.open = light.is_delta() ? 0 : 1;
        Step step;
        step.d = ray.d;
        step.pdf = light.is_infinite() ? ray.pdf_position : ray.pdf_direction;
        step.parallel = light.is_infinite();
        step.before = x.open;
        step.medium = ray.medium;
        if (!(ray.pdf_direction > 0)) return;
        step.beta = Batch(ray.cosine * ray.profile / (odds * ray.pdf_position * ray.pdf_direction));
        lights_.multiply_emission(chosen_, ray.anchor.ng, ray.d, sample_.spectra, step.beta);
        if (!step.beta.is_black()) walk(light_, false, step);
    }

    // Extends a subpath step by step until it is absorbed, leaves, or is long enough.
    void walk(Subpath& path, bool from_eye, Step& step) {
        float eta2 = 1;
        while (find_vertex(path, from_eye, step)) {
            const std::size_t i = path.size() - 1;
            const SubpathVertex& x = path[i];
            Scattering::Sample next;
            Batch weight(1.0f);
            if (!x.scattering.sample(x.wo, from_eye, number(from_eye, i, Dimension::kLobe),
                                     number(from_eye, i, Dimension::kDirectionU), number(from_eye, i, Dimension::kDirectionV), next,
                                     weight)) {
                return;
            }
            step.through *= weight;
            step.beta *= weight;
            step.dispersed = x.dispersed || x.scattering.disperses(x.wo, next.wi);
            if (from_eye) eta2 *= next.eta2;
            const float odds = survival_odds(step.through, eta2, step.dispersed, sample_.kept);
            if (!(odds > 0)) return;
            if (i >= 2 && odds < 1) {
                if (number(from_eye, i, Dimension::kSurvival) >= odds) return;
                step.through *= 1 / odds;
                step.beta *= 1 / odds;
            }
            step.before = x.open + chained(next.pdf_reverse * x.to_previous, path[i - 1].forward, x.before);
            step.d = next.wi;
            step.pdf = next.pdf;
            step.parallel = false;
            step.medium = x.medium_towards(next.wi);
        }
    }

    // Follows a step to the vertex that it reaches and appends that; gathers what shines on the way, or the lens that it meets.
    // False: there is none, or none that could be connected within the depth.
    bool find_vertex(Subpath& path, bool from_eye, Step& step) {
        const std::size_t i = path.size();
        const bool from_sky = !from_eye && i == 1 && step.parallel;
        Line line;
        line.first_medium = step.medium;
        Ray ray = from_sky ? Ray{path[0].at.p, step.d} : spawn_ray(path[i - 1].at, step.d);
        for (std::uint32_t stretch = 0;; ++stretch) {
            const std::optional<SurfaceHit> hit = world_.geometry().intersect(ray);
            MediumStep length{false, hit ? hit->t : kFar, 1, 1};
            Batch weight(1.0f);
            if (step.medium != kNone) {
                const std::uint32_t again = stretch << 24;  // behind an interface a step needs numbers of its own
                length = sample_step(world_.medium(step.medium), length.t, number(from_eye, i, Dimension::kDistanceChannel + again),
                                     number(from_eye, i, Dimension::kDistance + again), sample_.spectra, weight);
            }
            if (!from_eye && world_.camera().has_lens()) reach_lens(step, line, ray, length.t);
            step.beta *= weight;
            step.through *= weight;
            line.last_medium = step.medium;
            line.last_length = length.t;
            if (stretch == 0) line.first_length = length.t;
            const float density = line.passing * length.density;
            line.passing *= length.passing;
            if (length.scattered) {
                SubpathVertex x;
                x.at = {ray.o + ray.d * length.t, 0, {}};
                x.in_medium = true;
                x.scattering = Scattering::phase(world_.medium(step.medium).g);
                return append(path, from_eye, x, step, line, density);
            }
            if (!hit) {
                if (from_eye) see_sky(step, line);
                return false;
            }
            if (from_eye && hit->emitter != kNone) see_light(*hit, step, line);
            if (!World::is_interface(hit->material)) {
                if (i + 2 > most_) return false;
                SubpathVertex x;
                x.at = hit->anchor();
                x.normal = hit->ng;
                x.scattering = world_.scattering(*hit, sample_.spectra, sample_.kept);
                x.inside_medium = hit->inside_medium;
                x.outside_medium = hit->outside_medium;
                return append(path, from_eye, x, step, line, density);
            }
            step.medium = World::medium_beyond(*hit, step.d, step.medium);
            ray = spawn_ray(hit->anchor(), step.d);
        }
    }

    bool append(Subpath& path, bool from_eye, SubpathVertex& x, const Step& step, const Line& line, float density) {
        const std::size_t i = path.size();
        if (i + 2 > most_) return false;
        const SubpathVertex& previous = path[i - 1];
        const float d2 = length_squared(x.at.p - previous.at.p);
        x.wo = -step.d;
        x.beta = step.beta;
        x.medium = step.medium;
        x.dispersed = step.dispersed;
        x.before = step.before;
        x.forward = density * step.pdf * x.cosine(step.d) / (step.parallel ? 1 : d2);
        x.to_previous = passed_to(previous, line) * (step.parallel ? 1 : previous.cosine(step.d) / d2);
        x.open = (i == 1 || previous.connectible()) && x.connectible() ? 1 : 0;
        if (!from_eye && i == 1) x.open *= resampled(x, previous, step.d, d2);
        path.push_back(x);
        return true;
    }

    // Square of the density of the light subpath's first point as sampled from its second vertex x, over that as the start of a
    // ray.
    float resampled(const SubpathVertex& x, const SubpathVertex& first, const Vec3f& d, float d2) const {
        const Light& light = lights_[chosen_];
        if (light.is_delta()) return 1;
        const float ratio = light.is_infinite() ? lights_.pdf_of_direction(chosen_, -d, x.scattering.receiver(x.wo)) /
                                                      lights_.pdf_of_emission(chosen_, {}, d)
                                                : lights_.pdf_of_point(chosen_, x.at.p, first.at.p, first.normal) *
                                                      first.cosine(d) / d2 / lights_.pdf_of_position(chosen_);
        return ratio * ratio;
    }

    // Density, for the end x of a line, of what the line has to do with it: the odds of passing the line, or, in a medium, of being
    // stopped at x.
    float passed_to(const SubpathVertex& x, std::uint32_t medium, float length, float passing) const {
        return medium == kNone || !x.in_medium ? passing
                                               : passing * scattering_over_passing(world_.medium(medium), length, sample_.spectra);
    }
    float passed_to(const SubpathVertex& first, const Line& line) const {
        return passed_to(first, line.first_medium, line.first_length, line.passing);
    }

    // s = 0: the eye's step ends on light i. `forward`: density of that point; `point` and `ray`: densities of the same by sampling
    // a point of the light, and as the start of a ray; `reverse`: density of the eye's last vertex from there.
    void add_emission(Batch value, const Step& step, float forward, float point, float ray, float reverse) {
        const SubpathVertex& last = eye_.back();
        const bool connected = eye_.size() >= 2 && last.connectible();
        const float sampled = connected ? chained(point, forward, 1) : 0;
        const float shorter = chained(ray, forward, chained(reverse, last.forward, step.before));
        value *= weight(0, eye_.size() + 1, sampled + shorter);
        camera_.add(value, step.dispersed, sample_.kept, sample_.k());
    }
    void see_light(const SurfaceHit& hit, const Step& step, const Line& line) {
        const Light& light = lights_[hit.emitter];
        if (!light.two_sided && dot(hit.ng, step.d) >= 0) return;
        Batch value = step.beta;
        lights_.multiply_emission(hit.emitter, hit.ng, -step.d, sample_.spectra, value);
        const SubpathVertex& last = eye_.back();
        const float d2 = length_squared(hit.p - last.at.p), to_area = abs_dot(hit.ng, step.d) / d2,
                    odds = lights_.probability(hit.emitter);
        add_emission(value, step, step.pdf * (step.parallel ? to_area * d2 : to_area) * line.passing,
                     odds * lights_.pdf_of_point(hit.emitter, last.at.p, hit.p, hit.ng) * to_area,
                     odds * lights_.pdf_of_position(hit.emitter),
                     lights_.pdf_of_emission(hit.emitter, hit.ng, -step.d) * last.cosine(step.d) / d2 * passed_to(last, line));
    }
    void see_sky(const Step& step, const Line& line) {
        const SubpathVertex& last = eye_.back();
        for (const std::uint32_t i : lights_.infinite()) {
            if (lights_[i].is_delta()) continue;
            Batch value = step.beta;
            lights_.multiply_emission(i, {}, -step.d, sample_.spectra, value);
            const float odds = lights_.probability(i),
                        point = odds * lights_.pdf_of_direction(i, step.d, last.scattering.receiver(last.wo));
            const float ray = odds * lights_.pdf_of_emission(i, {}, -step.d);
            add_emission(value, step, step.pdf * line.passing, point, ray,
                         lights_.pdf_of_position(i) * last.cosine(step.d) * passed_to(last, line));
        }
    }

    // t = 0: the light's step meets the lens before it has gone `limit`. Lights that are a point or a direction are themselves
    // invisible, as they are to a path from the eye.
    void reach_lens(const Step& step, const Line& so_far, const Ray& ray, float limit) {
        CameraPoint point;
        if (light_.size() == 1 && lights_[chosen_].is_delta()) return;
        if (!world_.camera().hit_lens(ray.o, ray.d, limit, point)) return;
        Batch value = step.beta;
        Line line = so_far;
        if (step.medium != kNone) {
            const float passing = multiply_transmittance(world_.medium(step.medium), point.distance, sample_.spectra, value);
            value *= 1 / passing;
            line.passing *= passing;
        }
        if (line.first_length == 0) line.first_length = point.distance;
        const SubpathVertex& last = light_.back();
        const float d2 = length_squared(point.p - last.at.p), area = world_.camera().lens_area();
        const float cosine = abs_dot(point.w, world_.camera().axis());
        const float forward = step.pdf * line.passing * cosine / (step.parallel ? 1 : d2);
        const float reverse = point.jacobian * passed_to(last, line) * (step.parallel ? 1 : last.cosine(step.d) / d2);
        const float open = light_.size() >= 2 && last.connectible() ? 1 : 0;
        value *= point.jacobian / (area * cosine) *
                 weight(light_.size() + 1, 0, chained(1 / area, forward, open + chained(reverse, last.forward, step.before)));
        splat(point, value, step.dispersed);
    }
    void splat(const CameraPoint& point, const Batch& value, bool dispersed) {
        Radiance radiance;
        radiance.add(value, dispersed, sample_.kept, sample_.k());
        records_.light(sample_.numbers.n, point.u, point.v, radiance, sample_.spectra.wavelengths, sample_.kept, out_, faults_);
    }

    // s = 1: a point of a light for eye vertex i.
    void join_light(std::size_t i) {
        const SubpathVertex& z = eye_[i];
        if (!z.connectible()) return;
        const std::uint32_t chosen = lights_.choose(eye_number(i - 1, Dimension::kLight));
        const Light& light = lights_[chosen];
        LightPoint point;
        if (!lights_.sample_point(chosen, z.at.p, z.scattering.receiver(z.wo), eye_number(i - 1, Dimension::kLightU),
                                  eye_number(i - 1, Dimension::kLightV), point))
            return;
        const float scattering_pdf = z.scattering.pdf_omega(z.wo, point.wi);
        if (!(scattering_pdf > 0)) return;
        Batch value = z.beta;
        z.scattering.multiply_f_cos(z.wo, point.wi, value);
        lights_.multiply_emission(chosen, point.anchor.ng, -point.wi, sample_.spectra, value);
        if (value.is_black()) return;
        Line line;
        const std::uint32_t medium = z.medium_towards(point.wi);
        const bool seen = light.is_infinite() ? world_.connect_sky(z.at, point.wi, medium, sample_.spectra, value, line)
                                              : world_.connect(z.at, point.anchor, medium, sample_.spectra, value, line);
        if (!seen) return;
        const float sampled = lights_.probability(chosen) * point.pdf_omega;
        value *= point.falloff / sampled;

        // Its light could have started a ray to z, with a density of its point that need not be the one drawn from here.
        const float cosine = z.cosine(point.wi);
        float reverse = passed_to(z, line);
        if (light.is_infinite()) {
            reverse *= lights_.pdf_of_position(chosen) * cosine;
            if (!light.is_delta()) reverse *= lights_.pdf_of_emission(chosen, {}, -point.wi) / point.pdf_omega;
        } else {
            reverse *= lights_.pdf_of_emission(chosen, point.anchor.ng, -point.wi) * cosine / (point.distance * point.distance);
        }
        if (light.has_area()) {
            const float to_area = abs_dot(point.anchor.ng, point.wi) / (point.distance * point.distance);
            reverse *= lights_.pdf_of_position(chosen) / (point.pdf_omega * to_area);
        }
        const float hit = light.is_delta() ? 0 : chained(scattering_pdf * line.passing, sampled, 1);
        const float previous = z.scattering.pdf_omega(point.wi, z.wo) * z.to_previous;
        value *= weight(1, i + 1, hit + connected_chain(eye_, i, reverse, previous));
        camera_.add(value, z.dispersed || z.scattering.disperses(z.wo, point.wi), sample_.kept, sample_.k());
    }

    // t = 1: light vertex i seen from a point of the lens.
    void join_lens(std::size_t i) {
        const SubpathVertex& y = light_[i];
        if (!y.connectible()) return;
        CameraPoint point;
        if (!world_.camera().connect(y.at.p, light_number(i, Dimension::kLightU), light_number(i, Dimension::kLightV), point))
            return;
        const Vec3f to_eye = -point.w;
        Batch value = y.beta;
        multiply_light_side(y, to_eye, value);
        if (value.is_black()) return;
        Line line;  // from y to the lens
        if (!world_.connect(y.at, {point.p, 0, {}}, y.medium_towards(to_eye), sample_.spectra, value, line)) return;
        const float d2 = point.distance * point.distance;
        const float density = point.jacobian / (point.parallel ? 1 : d2);
        value *= density;

        const float pdf = y.scattering.pdf_omega(y.wo, to_eye), previous = y.scattering.pdf_omega(to_eye, y.wo) * y.to_previous;
        const bool lens = world_.camera().has_lens();
        const float hit =
            lens ? chained(pdf * abs_dot(world_.camera().axis(), point.w) / d2 * line.passing, 1 / world_.camera().lens_area(), 1)
                 : 0;
        value *= weight(i + 1, 1, hit + connected_chain(light_, i, density * y.cosine(to_eye) * passed_to(y, line), previous));
        splat(point, value, y.dispersed || y.scattering.disperses(to_eye, y.wo));
    }

    // s, t >= 2: light vertex i with eye vertex j.
    void join(std::size_t i, std::size_t j, float factor) {
        const SubpathVertex& y = light_[i];
        const SubpathVertex& z = eye_[j];
        if (!y.connectible() || !z.connectible()) return;
        const Vec3f to = y.at.p - z.at.p;
        const float d2 = length_squared(to);
        if (!(d2 > 0)) return;
        const Vec3f w = to / std::sqrt(d2);
        const float pdf_z = z.scattering.pdf_omega(z.wo, w), pdf_y = y.scattering.pdf_omega(y.wo, -w);
        if (!(pdf_z > 0) || !(pdf_y > 0)) return;
        Batch value = y.beta * z.beta;
        multiply_light_side(y, -w, value);
        z.scattering.multiply_f_cos(z.wo, w, value);
        if (value.is_black()) return;
        Line line;  // from z to y
        if (!world_.connect(z.at, y.at, z.medium_towards(w), sample_.spectra, value, line)) return;
        value *= factor / d2;
        const float reverse_z = pdf_y * z.cosine(w) / d2 * passed_to(z, line);
        const float reverse_y = pdf_z * y.cosine(w) / d2 * passed_to(y, line.last_medium, line.last_length, line.passing);
        const float shorter_eye = connected_chain(eye_, j, reverse_z, z.scattering.pdf_omega(w, z.wo) * z.to_previous);
        const float shorter_light = connected_chain(light_, i, reverse_y, y.scattering.pdf_omega(-w, y.wo) * y.to_previous);
        value *= weight(i + 1, j + 1, shorter_eye + shorter_light);
        const bool dispersed = y.dispersed || z.dispersed || y.scattering.disperses(-w, y.wo) || z.scattering.disperses(z.wo, w);
        camera_.add(value, dispersed, sample_.kept, sample_.k());
    }

    // value *= f |w_light.ns| / |w_light.ng| |w_eye.ng|: what light vertex y sends towards the eye, over the cosine's share of d^2.
    static void multiply_light_side(const SubpathVertex& y, const Vec3f& w_eye, Batch& value) {
        y.scattering.multiply_f_cos(w_eye, y.wo, value);
        value *= y.cosine(w_eye) / y.cosine(y.wo);
    }

    // Combinatory optimisation [R06 4.6.3]: of the m pairs of connectible vertices that give a path of the same length, one, times
    // m.
    void join_one_of_each_length() {
        const std::size_t longest = std::min<std::size_t>(light_.size() + eye_.size() - 2, most_ - 2);
        for (std::size_t sum = 2; sum <= longest; ++sum) {  // i + j
            const std::size_t first = sum >= eye_.size() ? sum - eye_.size() + 1 : 1, last = std::min(sum - 1, light_.size() - 1);
            std::uint32_t m = 0;
            for (std::size_t i = first; i <= last; ++i) m += light_[i].connectible() && eye_[sum - i].connectible();
            if (m == 0) continue;
            std::uint32_t skip =
                std::min(static_cast<std::uint32_t>(eye_number(sum, Dimension::kConnection) * static_cast<float>(m)), m - 1);
            for (std::size_t i = first; i <= last; ++i) {
                if (light_[i].connectible() && eye_[sum - i].connectible() && skip-- == 0) {
                    join(i, sum - i, static_cast<float>(m));
                    break;
                }
            }
        }
    }

    const World& world_;
    const Lights& lights_;
    const bool all_;
    const std::size_t most_;  // vertices of a path, those on the light and on the lens included
    const RecordMaker& records_;
    SampleState& sample_;
    Subpath& eye_;
    Subpath& light_;
    const StrategyFault& fault_;
    std::uint32_t chosen_ = 0;  // the light that the light subpath starts on
    Radiance& camera_;
    sampledb::Records& out_;
    RadianceFaults& faults_;
};

class BdptIntegrator final : public Transport {
 public:
    BdptIntegrator(std::unique_ptr<World> world, const IntegratorSettings& settings, StrategyFault fault)
        : Transport(std::move(world), settings), fault_(fault) {}
    std::uint32_t light_paths_per_sample() const override { return 1; }

 protected:
    void trace_paths(SampleState& sample, double u, double v, Radiance& camera, sampledb::Records& out,
                     RadianceFaults& faults) const override {
        auto& [eye, light] = subpaths_.local();
        Bidirectional(world(), settings(), records(), sample, eye, light, fault_, camera, out, faults).trace(u, v);
    }

 private:
    StrategyFault fault_;
    mutable tbb::enumerable_thread_specific<std::pair<Subpath, Subpath>> subpaths_;  // room that is used again, sample after sample
};

}  // namespace

std::unique_ptr<Integrator> make_bdpt_integrator(std::unique_ptr<World> world, const IntegratorSettings& settings,
                                                 StrategyFault fault) {
    return std::make_unique<BdptIntegrator>(std::move(world), settings, fault);
}

}  // namespace latent::render
