#include "render/medium/heterogeneous.h"

#include <algorithm>
#include <cmath>

#include "render/math/elementary.h"

namespace latent::render {
namespace {

// Of each wavelength in the throughput; even if that is black.
SampledSpectrum shares(const SampledSpectrum& value, std::uint32_t k) {
    const float total = mean_over(value, k) * static_cast<float>(k);
    return spectrum_of([&](std::uint32_t i) { return i >= k ? 0 : total > 0 ? value.v[i] / total : 1 / static_cast<float>(k); });
}

std::uint32_t index_by(const SampledSpectrum& share, Uniform u, std::uint32_t k) {
    float left = u;
    std::uint32_t last = 0;
    for (std::uint32_t i = 0; i < k; ++i) {
        if (!(share[i] > 0)) continue;
        last = i;
        if (left < share[i]) break;
        left -= share[i];
    }
    return last;
}

float mean_by(const SampledSpectrum& share, const SampledSpectrum& value) {
    float sum = 0;
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) sum += share.v[i] * value.v[i];
    return sum;
}

// Optical depth to the next tentative collision.
float depth_of(float u) { return -log_one_minus(u); }
constexpr float kStop = -1;

}  // namespace

HeterogeneousMedium::UnitLine HeterogeneousMedium::unit_line(const Segment& segment) const {
    return {Vec3f(unit_from_world_.point(Vec3d(segment.o))),
            Vec3f(unit_from_world_.vector(Vec3d(segment.d) / length(Vec3d(segment.d))))};
}

float HeterogeneousMedium::deepest_cell(const SpectrumLibrary& library) const {
    const Affined world_from_unit = unit_from_world_.inverse().value_or(Affined{});
    const MajorantGrid::Size& size = majorants_.size();
    const double diagonal =
        length(world_from_unit.x) / size[0] + length(world_from_unit.y) / size[1] + length(world_from_unit.z) / size[2];
    return static_cast<float>(diagonal) * majorants_.max() * library[reference_sigma_t_].max_value();
}

template <class Collide>
float HeterogeneousMedium::track(const UnitLine& line, float end, float u, SampleState& sample, Collide collide) const {
    const float reference = sample.spectra[reference_sigma_t_].max();
    float depth = depth_of(u);
    float column = 0;
    const auto visit = [&](float enter, float leave, const MajorantGrid::Cell& cell) {
        const float mu = cell.max * reference;
        float t = enter;
        while (depth < mu * (leave - t)) {
            const float next = t + depth / mu;
            t = next > t ? next : std::nextafter(t, kInfinity);  // far away, a step may be too short for a float
            depth = collide(t, line.o + line.d * t, mu);
            if (depth == kStop) {
                column += cell.mean * (t - enter);
                return false;
            }
        }
        depth -= mu * (leave - t);
        column += cell.mean * (leave - enter);
        return true;
    };
    if (outside_.max == 0) {
        majorants_.traverse(line.o, line.d, end, visit);
        return column;
    }
    float at = 0;  // where the cube begins, and then ends
    bool goes_on = true;
    majorants_.traverse(line.o, line.d, end, [&](float enter, float leave, const MajorantGrid::Cell& cell) {
        if (enter > at) goes_on = visit(at, enter, outside_);
        at = leave;
        goes_on = goes_on && visit(enter, leave, cell);
        return goes_on;
    });
    if (goes_on && at < end) visit(at, end, outside_);
    return column;
}

MediumStep HeterogeneousMedium::sample_step(const Segment& segment, Uniform u_wavelength, Uniform u, SampleState& sample,
                                            SampledSpectrum& value, SampledSpectrum* emitted) const {
    const SampledSpectrum share = shares(value, sample.k());
    const std::uint32_t chosen = index_by(share, u_wavelength, sample.k());
    SampledSpectrum passed_null(1.0f);  // the product of (1 - a)
    SampledSpectrum sigma_t;
    float scattered_at = kInfinity;
    const UnitLine line = unit_line(segment);
    const float column = track(line, segment.length, u, sample, [&](float t, const Vec3f& p, float mu) {
        SampledSpectrum light;
        if (emitted != nullptr && emission(p, sample, light))
            *emitted += value * passed_null * light * (1 / (mu * mean_by(share, passed_null)));
        extinction(p, sample, sigma_t);
        const SampledSpectrum real = spectrum_of([&](std::uint32_t i) { return std::min(sigma_t.v[i] / mu, 1.0f); });
        if (sample.random() < real[chosen]) {
            SampledSpectrum sigma_s;
            scattering(p, sample, sigma_s);
            value *= passed_null;
            value *= sigma_s * (1 / (mu * mean_by(share, passed_null * real)));
            scattered_at = t;
            return kStop;
        }
        passed_null *= spectrum_of([&](std::uint32_t i) { return 1 - real.v[i]; });
        return depth_of(sample.random());
    });
    if (scattered_at < kInfinity) return vertex(scattered_at, column, sigma_t, sample);
    value *= passed_null * (1 / mean_by(share, passed_null));
    return passed(segment.length, column, sample);
}

float HeterogeneousMedium::multiply_transmittance(const UnitLine& line, float end, SampleState& sample,
                                                  SampledSpectrum& value) const {
    SampledSpectrum estimate(1.0f), sigma_t;
    const float u = sample.random();
    const float column = track(line, end, u, sample, [&](float, const Vec3f& p, float mu) {
        extinction(p, sample, sigma_t);
        estimate *= spectrum_of([&](std::uint32_t i) { return 1 - std::min(sigma_t.v[i] / mu, 1.0f); });
        // What has nearly nothing left is followed one time in four, and then counts four times.
        if (estimate.max() < 0.05f) estimate *= sample.random() < 0.25f ? 4 : 0;
        return estimate.is_black() ? kInfinity : depth_of(sample.random());
    });
    value *= estimate;
    return column;
}

MediumStep HeterogeneousMedium::scatter_at(const Segment& segment, float t, SampleState& sample, SampledSpectrum& value) const {
    const UnitLine line = unit_line(segment);
    const Vec3f p = line.o + line.d * t;
    SampledSpectrum sigma_t, sigma_s;
    extinction(p, sample, sigma_t);
    scattering(p, sample, sigma_s);
    value *= sigma_s;
    return vertex(t, multiply_transmittance(line, t, sample, value), sigma_t, sample);
}

MediumStep HeterogeneousMedium::multiply_transmittance(const Segment& segment, SampleState& sample, SampledSpectrum& value) const {
    return passed(segment.length, multiply_transmittance(unit_line(segment), segment.length, sample, value), sample);
}

namespace {

SampledSpectrum model_transmittance(const SampledSpectrum& reference, float column) {
    return spectrum_of([&](std::uint32_t i) { return exp_nonpositive(-reference.v[i] * column); });
}

}  // namespace

MediumStep HeterogeneousMedium::vertex(float t, float column, const SampledSpectrum& sigma_t, SampleState& sample) const {
    const SampledSpectrum transmittance = model_transmittance(sample.spectra[reference_sigma_t_], column);
    return {true, t, mean_over(transmittance * sigma_t, sample.k()), mean_over(transmittance, sample.k()), column};
}

MediumStep HeterogeneousMedium::passed(float t, float column, SampleState& sample) const {
    const float mean = mean_over(model_transmittance(sample.spectra[reference_sigma_t_], column), sample.k());
    return {false, t, mean, mean, column};
}

float HeterogeneousMedium::scattering_over_transmittance(const Vec3f& p, float column, SampleState& sample) const {
    SampledSpectrum sigma_t;
    extinction(unit_point(p), sample, sigma_t);
    const MediumStep step = vertex(0, column, sigma_t, sample);
    return step.density / step.transmittance;
}

}  // namespace latent::render
