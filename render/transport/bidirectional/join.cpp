#include "render/transport/bidirectional/join.h"

namespace latent::render {

void SubpathJoin::join_lens() {
    for (std::size_t i = 1; i < subpaths_.light.size(); ++i) join_lens(i);
}

void SubpathJoin::join_all(Connections connections) {
    for (std::size_t i = 1; i < subpaths_.camera.size(); ++i) join_light(i);
    if (connections == Connections::kAll) {
        for (std::size_t i = 1; i < subpaths_.light.size(); ++i) {
            for (std::size_t j = 1; j < subpaths_.camera.size() && i + j + 2 <= max_vertices_; ++j) join(i, j, 1);
        }
    } else {
        join_one_of_each_length();
    }
}

void SubpathJoin::join_light(std::size_t i) {
    const SubpathVertex& z = subpaths_.camera[i];
    if (!z.connectible() || lights_.size() == 0) return;
    const LightSampleContext context = z.scattering.light_sample_context(z.wo);
    const ChosenLight chosen = lights_.choose(camera_number(i - 1, Dimension::kLightU), z.at.p, context);
    if (!(chosen.probability > 0)) return;
    const Light& light = lights_[chosen.light];
    LightPoint point;
    if (!light.sample_point(z.at.p, context, chosen.rest, camera_number(i - 1, Dimension::kLightV), point)) return;
    const float scattering_pdf = z.scattering.pdf_omega(z.wo, point.wi, true);
    if (!(scattering_pdf > 0)) return;
    SampledSpectrum value = z.beta;
    z.scattering.multiply_f_cos(z.wo, point.wi, value);
    if (!light.multiply_emission(point.point(), -point.wi, sample_.spectra, value) || value.is_black()) return;
    LineOfSight line;
    const std::uint32_t medium = z.medium_towards(point.wi);
    const bool seen = light.is_infinite() ? world_.connect_infinite(z.at, point.wi, medium, sample_, value, line)
                                          : world_.connect(z.at, point.at, medium, sample_, value, line);
    if (!seen) return;
    const float sampled = chosen.probability * point.pdf_omega;
    value *= point.falloff / sampled;

    // Its light could have started a ray to z, with a density of its point that need not be the one drawn from here: nor need the
    // light's own probability be.
    const float cosine = z.cosine_from(point.wi);
    float pdf_reverse = distance_pdf(z, line);
    if (light.is_infinite()) {
        pdf_reverse *= light.pdf_position() * cosine;
        if (!light.is_delta()) pdf_reverse *= light.pdf_direction({}, -point.wi) / point.pdf_omega;
    } else {
        pdf_reverse *= light.pdf_direction(point.at.ng, -point.wi) * cosine / (point.distance * point.distance);
    }
    if (light.has_area()) {
        const float to_area = abs_dot(point.at.ng, point.wi) / (point.distance * point.distance);
        pdf_reverse *= light.pdf_position() / (point.pdf_omega * to_area);
    }
    pdf_reverse *= lights_.probability(chosen.light) / chosen.probability;
    const float hit = light.can_be_met() ? mis_term(scattering_pdf * line.transmittance, sampled, 1) : 0;
    const float previous_pdf_reverse = z.scattering.pdf_omega(point.wi, z.wo, false) * z.to_previous_area;
    value *= mis_weight(hit + mis_sum(subpaths_.camera, i, pdf_reverse, previous_pdf_reverse));
    seen_.add(value, z.dispersed || z.scattering.disperses(z.wo, point.wi), light.id());
}

void SubpathJoin::join_lens(std::size_t i) {
    const SubpathVertex& y = subpaths_.light[i];
    if (!y.connectible()) return;
    CameraPoint point;
    if (!camera_.connect(y.at.p, light_number(i, Dimension::kLightU), light_number(i, Dimension::kLightV), point)) return;
    const Vec3f to_camera = -point.w;
    SampledSpectrum value = y.beta;
    multiply_light_side(y, to_camera, value);
    if (value.is_black()) return;
    LineOfSight line;  // from y to the lens
    if (!world_.connect(y.at, {point.p, 0, {}}, y.medium_towards(to_camera), sample_, value, line, true)) return;
    const float d2 = point.distance * point.distance;
    const float density = point.jacobian / (point.parallel ? 1 : d2);
    value *= density;

    const float pdf = y.scattering.pdf_omega(y.wo, to_camera, false),
                previous_pdf_reverse = y.scattering.pdf_omega(to_camera, y.wo, true) * y.to_previous_area;
    const float hit = lens_can_be_hit()
                          ? mis_term(pdf * abs_dot(camera_.axis(), point.w) / d2 * line.transmittance, 1 / camera_.lens_area(), 1)
                          : 0;
    value *=
        mis_weight(hit + mis_sum(subpaths_.light, i, density * y.cosine(to_camera) * distance_pdf(y, line), previous_pdf_reverse));
    write_light(point, value, y.dispersed || y.scattering.disperses(to_camera, y.wo));
}

void SubpathJoin::join(std::size_t i, std::size_t j, float factor) {
    const SubpathVertex& y = subpaths_.light[i];
    const SubpathVertex& z = subpaths_.camera[j];
    if (!y.connectible() || !z.connectible()) return;
    const Vec3f to = y.at.p - z.at.p;
    const float d2 = length_squared(to);
    if (!(d2 > 0)) return;
    const Vec3f w = to / std::sqrt(d2);
    const float pdf_z = z.scattering.pdf_omega(z.wo, w, true), pdf_y = y.scattering.pdf_omega(y.wo, -w, false);
    if (!(pdf_z > 0)) return;
    SampledSpectrum value = y.beta * z.beta;
    multiply_light_side(y, -w, value);
    z.scattering.multiply_f_cos(z.wo, w, value);
    if (value.is_black()) return;
    LineOfSight line;  // from z to y
    if (!world_.connect(z.at, y.at, z.medium_towards(w), sample_, value, line)) return;
    value *= factor / d2;
    const float pdf_reverse_z = pdf_y * z.cosine_from(w) / d2 * distance_pdf(z, line);
    const float pdf_reverse_y = pdf_z * y.cosine(w) / d2 * distance_pdf(y, line.last_medium, line.last_column, line.transmittance);
    const float shorter_camera =
        mis_sum(subpaths_.camera, j, pdf_reverse_z, z.scattering.pdf_omega(w, z.wo, false) * z.to_previous_area);
    const float shorter_light =
        mis_sum(subpaths_.light, i, pdf_reverse_y, y.scattering.pdf_omega(-w, y.wo, true) * y.to_previous_area);
    value *= mis_weight(shorter_camera + shorter_light);
    const bool dispersed = y.dispersed || z.dispersed || y.scattering.disperses(-w, y.wo) || z.scattering.disperses(z.wo, w);
    seen_.add(value, dispersed, lights_[subpaths_.start_light].id());
}

void SubpathJoin::multiply_light_side(const SubpathVertex& y, const Vec3f& w_camera, SampledSpectrum& value) {
    y.scattering.multiply_f_cos(w_camera, y.wo, value);
    value *= y.cosine(w_camera) / y.cosine(y.wo);
}

void SubpathJoin::join_one_of_each_length() {
    const std::size_t longest = std::min<std::size_t>(subpaths_.light.size() + subpaths_.camera.size() - 2, max_vertices_ - 2);
    for (std::size_t sum = 2; sum <= longest; ++sum) {  // i + j
        const std::size_t first = sum >= subpaths_.camera.size() ? sum - subpaths_.camera.size() + 1 : 1,
                          last = std::min(sum - 1, subpaths_.light.size() - 1);
        std::uint32_t m = 0;
        for (std::size_t i = first; i <= last; ++i)
            m += subpaths_.light[i].connectible() && subpaths_.camera[sum - i].connectible();
        if (m == 0) continue;
        std::uint32_t skip = camera_number(sum, Dimension::kConnection).index(m);
        for (std::size_t i = first; i <= last; ++i) {
            if (subpaths_.light[i].connectible() && subpaths_.camera[sum - i].connectible() && skip-- == 0) {
                join(i, sum - i, static_cast<float>(m));
                break;
            }
        }
    }
}

}  // namespace latent::render
