#include "render/transport/bidirectional/walk.h"

#include <algorithm>

namespace latent::render {

void SubpathWalk::trace_camera(Vec2d film) {
    const Camera& camera = camera_;
    const bool lens = camera.has_lens();
    subpaths_.camera.resize(1);
    SubpathVertex& x = subpaths_.camera[0];
    Step step;
    Vec3f origin;
    camera.ray(film.x, film.y, camera.lens_point(sample_.numbers), origin, step.d);
    x = {};
    x.at = {origin, 0, {}};
    x.normal = camera.axis();
    x.pdf_forward = lens ? 1 / camera.lens_area() : 1;
    x.mis.end = lens_can_be_hit() ? 1 : 0;
    step.pdf = camera.jacobian(step.d);
    step.parallel = camera.parallel();
    step.mis_shorter = x.mis.end;
    step.medium = world_.medium_at_start(x.at.p, step.d, camera.medium(), sample_);
    step.beta = SampledSpectrum(1.0f);
    walk(subpaths_.camera, true, step);
}

void SubpathWalk::trace_light() {
    subpaths_.light.resize(1);
    if (lights_.size() == 0) return;  // media shine
    const ChosenLight chosen = lights_.choose(sample_.numbers(Dimension::kStartU));
    subpaths_.start_light = chosen.light;
    const Light& light = lights_[subpaths_.start_light];
    LightRay ray;
    light.sample_ray(chosen.rest, sample_.numbers(Dimension::kStartV), sample_.numbers(Dimension::kStartDirectionU),
                     sample_.numbers(Dimension::kStartDirectionV), ray);
    const float probability = chosen.probability;
    subpaths_.light.resize(1);
    SubpathVertex& x = subpaths_.light[0];
    x = {};
    x.at = ray.at;
    x.normal = ray.at.ng;
    x.pdf_forward = probability * (light.is_infinite() ? ray.pdf_direction : ray.pdf_position);
    x.mis.end = light.can_be_met() ? 1 : 0;
    Step step;
    step.d = ray.d;
    step.pdf = light.is_infinite() ? ray.pdf_position : ray.pdf_direction;
    step.parallel = light.is_infinite();
    step.mis_shorter = x.mis.end;
    step.medium = light.is_infinite() ? world_.medium_at_infinity() : ray.medium;
    if (!light.is_infinite()) step.medium = world_.medium_at_start(x.at.p, ray.d, step.medium, sample_);
    if (!(ray.pdf_direction > 0)) return;
    step.beta = SampledSpectrum(ray.cosine * ray.profile / (probability * ray.pdf_position * ray.pdf_direction));
    if (!light.multiply_emission(ray.point(), ray.d, sample_.spectra, step.beta) || step.beta.is_black()) return;
    walk(subpaths_.light, false, step);
}

void SubpathWalk::walk(Subpath& path, bool from_camera, Step& step) {
    float eta2 = 1;
    while (find_vertex(path, from_camera, step)) {
        const std::size_t i = path.size() - 1;
        const SubpathVertex& x = path[i];
        BsdfSample next;
        SampledSpectrum weight(1.0f);
        if (!x.scattering.sample(x.wo, from_camera, number(from_camera, i, Dimension::kLobe),
                                 number(from_camera, i, Dimension::kDirectionU), number(from_camera, i, Dimension::kDirectionV),
                                 next, weight)) {
            return;
        }
        step.throughput *= weight;
        step.beta *= weight;
        step.dispersed =
            x.dispersed || (from_camera ? x.scattering.disperses(x.wo, next.wi) : x.scattering.disperses(next.wi, x.wo));
        if (from_camera) eta2 *= next.eta2;
        const float survival =
            survival_probability(step.throughput, eta2, step.dispersed, sample_.kept, x.scattering.in_medium(), i);
        if (survival <= 0) return;
        if (i >= 2 && survival < 1) {
            if (number(from_camera, i, Dimension::kSurvival) >= survival) return;
            step.throughput *= 1 / survival;
            step.beta *= 1 / survival;
        }
        const float pdf_reverse = x.scattering.pdf_reverse(x.wo, next, from_camera) * x.to_previous_area;
        step.mis_shorter = (next.delta ? 0 : x.mis.end) + mis_term(pdf_reverse, path[i - 1].pdf_forward, x.mis.shorter);
        step.d = next.wi;
        step.pdf = next.pdf;
        step.delta = next.delta;
        step.scattered = step.scattered || !next.delta;
        step.parallel = false;
        step.medium = x.medium_towards(next.wi);
    }
}

bool SubpathWalk::find_vertex(Subpath& path, bool from_camera, Step& step) {
    const std::size_t i = path.size();
    const bool from_infinity = !from_camera && i == 1 && step.parallel;
    const Ray ray = (from_infinity ? Ray{path[0].at.p, step.d} : spawn_ray(path[i - 1].at, step.d))
                        .at_time(sample_.time, from_camera && !step.scattered);
    const Line sight = world_.geometry().trace(ray, Stop::kFirstSolid);
    if (from_infinity) {
        step.medium = sight.medium_before(step.d).value_or(step.medium);
        if (world_.is_endless(step.medium)) return false;  // no light comes through
    }
    LineOfSight line;
    March march(sight, ray, kFar, step.medium);
    float density = 1;
    do {
        const Segment& segment = march.segment();
        step.medium = segment.medium;
        MediumStep medium_step{false, segment.length, 1, 1, segment.length};
        SampledSpectrum weight(1.0f);
        if (!from_camera && lens_can_be_hit()) reach_lens(step, line, segment);
        if (step.medium != kNone) {
            const Medium& medium = world_.medium(step.medium);
            const bool emits = from_camera && medium.is_emissive();
            SampledSpectrum emitted(0.0f);
            const auto number_here = [&](std::uint32_t what) {
                return sample_.numbers(Dimension::behind(segment.index, dimension(from_camera, i, what)));
            };
            medium_step = medium.sample_step(segment, number_here(Dimension::kDistanceChannel), number_here(Dimension::kDistance),
                                             sample_, weight, emits ? &emitted : nullptr);
            if (emits) seen_.add(step.beta * emitted, step.dispersed, kNone);
        }
        step.beta *= weight;
        step.throughput *= weight;
        density = line.transmittance * medium_step.density;
        line.add(segment, medium_step.transmittance, medium_step.column);
        if (medium_step.scattered) {
            SubpathVertex x;
            x.at = {segment.o + segment.d * medium_step.t, 0, {}};
            x.in_medium = true;
            x.scattering = world_.medium(step.medium).phase(x.at.p, sample_);
            return append(path, from_camera, x, step, line, density);
        }
    } while (march.next());
    if (!sight.hit) {
        if (from_camera) see_infinite_lights(step, line);
        return false;
    }
    const SurfaceHit& hit = *sight.hit;
    if (from_camera && hit.emitter != kNone) see_light(hit, step, line);
    if (i + 2 > max_vertices_) return false;
    SubpathVertex x;
    x.at = hit.interaction();
    x.normal = hit.ng;
    x.scattering = world_.bsdf(hit, sample_.spectra, sample_.kept);
    x.media = media_at(hit);
    x.backdrop = hit.backdrop;
    return append(path, from_camera, x, step, line, density);
}

bool SubpathWalk::append(Subpath& path, bool from_camera, SubpathVertex& x, const Step& step, const LineOfSight& line,
                         float density) {
    const std::size_t i = path.size();
    if (i + 2 > max_vertices_) return false;
    const SubpathVertex& previous = path[i - 1];
    if (!from_camera && i == 1 && !lights_[subpaths_.start_light].reaches(x.at.p, -step.d)) return false;
    const float d2 = length_squared(x.at.p - previous.at.p);
    x.wo = -step.d;
    x.beta = step.beta;
    x.medium = step.medium;
    x.dispersed = step.dispersed;
    x.mis.shorter = step.mis_shorter;
    x.pdf_forward = density * step.pdf * x.cosine(step.d) / (step.parallel ? 1 : d2);
    x.to_previous_area = distance_pdf(previous, line) * (step.parallel ? 1 : previous.cosine_from(step.d) / d2);
    x.mis.end = !step.delta && x.connectible() ? 1 : 0;
    if (!from_camera && i == 1) x.mis.end *= light_point_ratio2(x, previous, step.d, d2);
    path.push_back(x);
    return true;
}

float SubpathWalk::light_point_ratio2(const SubpathVertex& x, const SubpathVertex& first, const Vec3f& d, float d2) const {
    const Light& light = lights_[subpaths_.start_light];
    const LightSampleContext context = x.scattering.light_sample_context(x.wo);
    float ratio = lights_.probability(subpaths_.start_light, x.at.p, context) / lights_.probability(subpaths_.start_light);
    if (!light.is_delta()) {
        const float pdf = light.pdf_omega(x.at.p, context, {-d, first.at.p, first.normal});
        ratio *= light.is_infinite() ? pdf / light.pdf_direction({}, d) : pdf * first.cosine(d) / d2 / light.pdf_position();
    }
    return ratio * ratio;
}

void SubpathWalk::add_emission(SampledSpectrum value, const Step& step, float pdf_forward, float pdf_point, float pdf_ray,
                               float pdf_reverse, std::uint32_t light) {
    const SubpathVertex& last = subpaths_.camera.back();
    const bool connected = subpaths_.camera.size() >= 2 && !step.delta;
    const float sampled = connected ? mis_term(pdf_point, pdf_forward, 1) : 0;
    const float shorter = mis_term(pdf_ray, pdf_forward, mis_term(pdf_reverse, last.pdf_forward, step.mis_shorter));
    value *= mis_weight(sampled + shorter);
    seen_.add(value, step.dispersed, light);
}

void SubpathWalk::see_light(const SurfaceHit& hit, const Step& step, const LineOfSight& line) {
    const Light& light = lights_[hit.emitter];
    SampledSpectrum value = step.beta;
    const LightHit at{step.d, hit.p, hit.ng, hit.on.uv};
    if (!light.multiply_emission(at.point(), -step.d, sample_.spectra, value)) return;
    const SubpathVertex& last = subpaths_.camera.back();
    const LightSampleContext context = last.scattering.light_sample_context(last.wo);
    const float d2 = length_squared(hit.p - last.at.p), to_area = abs_dot(hit.ng, step.d) / d2;
    const float pdf_point =
        lights_.probability(hit.emitter, last.at.p, context) * light.pdf_omega(last.at.p, context, at) * to_area;
    add_emission(value, step, step.pdf * (step.parallel ? to_area * d2 : to_area) * line.transmittance, pdf_point,
                 lights_.probability(hit.emitter) * light.pdf_position(),
                 light.pdf_direction(hit.ng, -step.d) * last.cosine_from(step.d) / d2 * distance_pdf(last, line), light.id());
}

void SubpathWalk::see_infinite_lights(const Step& step, const LineOfSight& line) {
    const SubpathVertex& last = subpaths_.camera.back();
    for (const std::uint32_t i : lights_.infinite()) {
        const Light& light = lights_[i];
        SampledSpectrum value = step.beta;
        if (!light.multiply_emission(LightHit{step.d, last.at.p}.point(), -step.d, sample_.spectra, value)) continue;
        const LightSampleContext context = last.scattering.light_sample_context(last.wo);
        const float pdf_point = lights_.probability(i, last.at.p, context) * light.pdf_omega(last.at.p, context, {step.d});
        const float pdf_ray = lights_.probability(i) * light.pdf_direction({}, -step.d);
        add_emission(value, step, step.pdf * line.transmittance, pdf_point, pdf_ray,
                     light.pdf_position() * last.cosine_from(step.d) * distance_pdf(last, line), light.id());
    }
}

void SubpathWalk::reach_lens(const Step& step, LineOfSight line, Segment segment) {
    CameraPoint point;
    if (!camera_.hit_lens(segment.o, segment.d, segment.length, point)) return;
    if (!lights_[subpaths_.start_light].can_be_met() && !step.scattered) return;
    if (subpaths_.light.size() == 1 && !lights_[subpaths_.start_light].reaches(point.p, point.w)) return;
    SampledSpectrum value = step.beta;
    segment.length = point.distance;
    if (step.medium == kNone) {
        line.add(segment, 1, segment.length);
    } else {
        const MediumStep to_lens = world_.medium(step.medium).multiply_transmittance(segment, sample_, value);
        line.add(segment, to_lens.transmittance, to_lens.column);
    }
    const SubpathVertex& last = subpaths_.light.back();
    const float d2 = length_squared(point.p - last.at.p), area = camera_.lens_area();
    const float cosine = abs_dot(point.w, camera_.axis());
    const float pdf_forward = step.pdf * line.transmittance * cosine / (step.parallel ? 1 : d2);
    const float pdf_reverse = point.jacobian * distance_pdf(last, line) * (step.parallel ? 1 : last.cosine_from(step.d) / d2);
    const float end = subpaths_.light.size() >= 2 && !step.delta ? 1 : 0;
    value *= point.jacobian / (area * cosine) *
             mis_weight(mis_term(1 / area, pdf_forward, end + mis_term(pdf_reverse, last.pdf_forward, step.mis_shorter)));
    write_light(point, value, step.dispersed);
}

}  // namespace latent::render
