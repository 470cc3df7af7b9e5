#include "render/bsdf/measured.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/math/elementary.h"

namespace latent::render {

namespace {

// The square of directions: sqrt(2 theta / pi), phi / (2 pi) + 1/2.
Vec2f place_of(const Vec3f& w) {
    const float ring = std::sqrt(w.x * w.x + w.y * w.y);
    if (!(ring > 0)) return {0, 0.5f};
    const float turns = w.y < 0 ? -angle_in_turns(w.x, -w.y) : angle_in_turns(w.x, w.y);
    return {std::sqrt(std::min(4 * angle_in_turns(w.z, ring), 1.0f)), 0.5f + turns};
}

struct Between {
    std::uint32_t below, above;  // two knots, or one twice
    float at;
};
Between between(const std::vector<float>& knots, float x) {
    if (knots.size() == 1) return {0, 0, 0};
    const auto above = static_cast<std::uint32_t>(std::upper_bound(knots.begin() + 1, knots.end() - 1, x) - knots.begin());
    return {above - 1, above, std::clamp((x - knots[above - 1]) / (knots[above] - knots[above - 1]), 0.0f, 1.0f)};
}

}  // namespace

MeasuredTables::MeasuredTables(std::shared_ptr<const MeasuredBrdf> brdf)
    : brdf_(std::move(brdf)),
      vndf_(brdf_->vndf.values, brdf_->vndf.width, brdf_->vndf.height),
      luminance_(brdf_->luminance.values, brdf_->luminance.width, brdf_->luminance.height) {}

MeasuredTables::View MeasuredTables::view(const Vec3f& w) const {
    View view;
    view.place = place_of(w);
    const Between theta = between(brdf_->theta, view.place.x * view.place.x * (kPi / 2)),
                  phi = between(brdf_->phi, (view.place.y - 0.5f) * (2 * kPi));
    const auto thetas = static_cast<std::uint32_t>(brdf_->theta.size());
    for (std::uint32_t c = 0; c < 4; ++c) {
        const bool next_phi = (c & 2) != 0, next_theta = (c & 1) != 0;
        view.mixture.table[c] = (next_phi ? phi.above : phi.below) * thetas + (next_theta ? theta.above : theta.below);
        view.mixture.share[c] = (next_phi ? phi.at : 1 - phi.at) * (next_theta ? theta.at : 1 - theta.at);
    }
    view.sigma = bilinear(brdf_->sigma.values, brdf_->sigma.width, brdf_->sigma.height, view.place);
    return view;
}

bool MeasuredTables::facet(const View& view, const Vec3f& w, const Vec3f& other, Facet& out) const {
    const Vec3f sum = w + other;
    if (!(dot(sum, sum) > 1e-12f)) return false;
    const Vec3f m = normalize(sum);
    out.place = place_of(m);
    const float from_pole = out.place.x;
    if (is_isotropic()) {
        out.place.y -= view.place.y - 0.5f;
        out.place.y -= std::floor(out.place.y);
    }
    out.drawn = vndf_.invert(view.mixture, out.place);
    // dm = 2 pi^2 x sin(theta) dx dy, and d(other) = 4 (w.m) dm.
    const float spread = 4 * dot(w, m) * std::max(2 * kPi * kPi * from_pole * std::sqrt(m.x * m.x + m.y * m.y), 1e-6f);
    if (!(spread > 0)) return false;
    out.pdf_omega = vndf_.density(view.mixture, out.place) * luminance_.density(view.mixture, out.drawn) / spread;
    return true;
}

Vec3f MeasuredTables::sample(const View& view, const Vec3f& w, float u, float v) const {
    const Vec2f drawn = luminance_.sample(view.mixture, u, v);
    const Vec2f place = vndf_.sample(view.mixture, drawn.x, drawn.y);
    const SinCos theta = sincos_turns(place.x * place.x * 0.25f),
                 phi = sincos_turns(place.y - 0.5f + (is_isotropic() ? view.place.y - 0.5f : 0));
    const Vec3f m{theta.sin * phi.cos, theta.sin * phi.sin, theta.cos};
    return m * (2 * dot(w, m)) - w;
}

// f cos = spectra D(m) / (4 sigma).
void MeasuredTables::multiply_f_cos(const View& view, const Facet& facet, const Wavelengths& wavelengths,
                                    SampledSpectrum& value) const {
    const SquareTable& ndf = brdf_->ndf;
    const float density = bilinear(ndf.values, ndf.width, ndf.height, facet.place);
    value *= spectra_at(view, facet.drawn, wavelengths);
    value *= view.sigma > 0 ? std::min(density / (4 * view.sigma), 1e30f) : 0;
}

SampledSpectrum MeasuredTables::spectra_at(const View& view, const Vec2f& drawn, const Wavelengths& wavelengths) const {
    const SquareTable& spectra = brdf_->spectra;
    const std::vector<float>& knots = brdf_->lambda_nm;
    const LatticeCell cell = lattice_cell(spectra.width, spectra.height, drawn);
    const std::size_t points = std::size_t{spectra.width} * spectra.height;
    // Four points of up to four tables.
    std::array<const float*, 16> at;
    std::array<float, 16> share;
    std::size_t count = 0;
    for (std::size_t t = 0; t < 4; ++t) {
        if (view.mixture.share[t] == 0) continue;
        for (std::size_t c = 0; c < 4; ++c, ++count) {
            at[count] = spectra.values.data() + (view.mixture.table[t] * points + cell.corner[c]) * knots.size();
            share[count] = view.mixture.share[t] * cell.share[c];
        }
    }
    SampledSpectrum out;
    float last = 0;
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) {
        if (i == 0 || i < wavelengths.k) {
            const Between lambda = between(knots, wavelengths.lambda_nm[i]);
            last = 0;
            for (std::size_t c = 0; c < count; ++c)
                last += share[c] * ((1 - lambda.at) * at[c][lambda.below] + lambda.at * at[c][lambda.above]);
        }
        out[i] = last;
    }
    return out;
}

// The mean of spectra over the square: of what a facet reflects once it is drawn by vndf alone.
SampledSpectrum MeasuredTables::albedo(const Wavelengths& wavelengths) const {
    const View up = view({0, 0, 1});
    SampledSpectrum sum(0.0f);
    constexpr int kSide = 4;
    for (int i = 0; i < kSide * kSide; ++i) {
        sum += spectra_at(up, {(static_cast<float>(i % kSide) + 0.5f) / kSide, (static_cast<float>(i / kSide) + 0.5f) / kSide},
                          wavelengths);
    }
    for (std::uint32_t i = 0; i < kMaxWavelengths; ++i) sum[i] = std::min(sum[i] / (kSide * kSide), 1.0f);
    return sum;
}

namespace {

// The same surface lies on both sides.
Vec3f turned_up(const Vec3f& w, bool flip) { return flip ? -w : w; }

}  // namespace

void Measured::multiply_f_cos(const Vec3f& w_camera, const Vec3f& w_light, SampledSpectrum& value) const {
    const Vec3f camera = turned_up(w_camera, w_camera.z < 0), light = turned_up(w_light, w_camera.z < 0);
    const MeasuredTables::View view = tables_->view(camera);
    MeasuredTables::Facet facet;
    if (tables_->facet(view, camera, light, facet)) {
        tables_->multiply_f_cos(view, facet, *wavelengths_, value);
    } else {
        value = SampledSpectrum(0.0f);
    }
}

float Measured::pdf_omega(const Vec3f& wo, const Vec3f& wi) const {
    const Vec3f from = turned_up(wo, wo.z < 0), to = turned_up(wi, wo.z < 0);
    MeasuredTables::Facet facet;
    return tables_->facet(tables_->view(from), from, to, facet) ? facet.pdf_omega : 0;
}

bool Measured::sample(const Vec3f& wo, float, float u, float v, ClosureSample& out, SampledSpectrum&) const {
    const Vec3f from = turned_up(wo, wo.z < 0);
    out.wi = turned_up(tables_->sample(tables_->view(from), from, u, v), wo.z < 0);
    return out.wi.z * wo.z > 0;
}

}  // namespace latent::render
