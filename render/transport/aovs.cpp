#include "render/transport/aovs.h"

#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "color/named_spectra.h"
#include "color/observer.h"

namespace latent::render {

namespace {

// Albedos and normals are multiples of 2^-12: as exact as the halves that pictures of them are kept in, and small when compressed.
float rounded(float x) { return std::floor(x * 4096 + 0.5f) / 4096; }

}  // namespace

void append(const AovSettings& settings, const Seen& seen, std::span<sampledb::ExtraColumn> columns) {
    const auto put = [&](const auto& value) {
        std::vector<std::byte>& values = columns.front().values;
        values.resize(values.size() + sizeof value);
        store_le(values.data() + values.size() - sizeof value, value);
        columns = columns.subspan(1);
    };
    const auto put_vector = [&](const Vec3f& v) { put(v.x), put(v.y), put(v.z); };
    if (settings.albedo) std::ranges::for_each(seen.albedo, put);
    if (settings.normal) put_vector(seen.normal);
    if (settings.depth) put(seen.depth);
    if (settings.position) put_vector(seen.position);
    if (settings.id) put(seen.object), put(seen.material);
    // In 1/256 of the range.
    const auto put_fraction = [&](float x) { put(static_cast<std::uint8_t>(std::clamp(x * 256, 0.0f, 255.0f))); };
    if (settings.lens) put_fraction((seen.lens.x + 1) / 2), put_fraction((seen.lens.y + 1) / 2);
    if (settings.time) put_fraction(seen.time);
}

Aovs::Aovs(const World& world, const AovSettings& settings, std::uint32_t max_depth)
    : world_(world),
      looks_(settings.sees_surfaces()),
      follows_deltas_(settings.albedo || settings.normal),
      max_deltas_(follows_deltas_ ? std::min(max_depth, kMaxDeltas) : 0) {
    const color::IntegerNmSpectrum light = color::sampled_at_integer_nm(color::illuminant_d65());
    for (std::size_t c = 0; c < 3; ++c) {
        const color::IntegerNmSpectrum curve = color::sampled_at_integer_nm(color::Observer::cie1931().curve(static_cast<int>(c)));
        for (std::size_t i = 0; i < lit_observer_.size(); ++i) {
            lit_observer_[i][c] = curve.value[i] * light.value[i];
            white_[c] += lit_observer_[i][c];
        }
    }
    const float y = white_[1];
    for (float& x : white_) x /= y;
}

// A ratio of two estimates, so that a neutral albedo is exact.
std::array<float, 3> Aovs::xyz_of(const SampledSpectrum& albedo, const Wavelengths& w) const {
    std::array<float, 4> seen{}, lit{};
    for (std::uint32_t i = 0; i < w.k; ++i) {
        const std::array<float, 4>&a = lit_observer_[w.below[i]], &b = lit_observer_[w.below[i] + 1];
        for (std::size_t c = 0; c < 4; ++c) {
            const float response = (a[c] + w.fraction[i] * (b[c] - a[c])) * w.weight[i];
            lit[c] += response;
            seen[c] += response * albedo[i];
        }
    }
    std::array<float, 3> xyz{};
    for (std::size_t c = 0; c < 3; ++c) {
        const float x = rounded(white_[c] * seen[c] / lit[c]);
        xyz[c] = std::isfinite(x) ? x : 0;
    }
    return xyz;
}

Seen Aovs::look(SampleState& sample, const Camera& camera, double u, double v) const {
    Seen seen;
    seen.depth = kInfinity;
    seen.lens = camera.lens_point(sample.numbers);
    seen.time = sample.numbers(Dimension::kTime);
    if (!looks_) return seen;
    Vec3f origin, d;
    camera.ray(u, v, seen.lens, origin, d);
    Interaction at{origin, 0, {}};
    SampledSpectrum passed(1.0f);  // share of the light that comes by mirrors and glass
    bool dispersed = false;
    for (std::uint32_t i = 0;; ++i) {
        const Line line = world_.geometry().trace(spawn_ray(at, d).at_time(sample.time, true), Stop::kFirstSolid);
        if (!line.hit) return seen;
        const SurfaceHit& hit = *line.hit;
        if (i == 0) {
            const Vec3d in_file = world_.in_file(hit.p);
            seen.depth = static_cast<float>(length(Vec3d(hit.p) - Vec3d(origin)));
            seen.position = Vec3f(in_file);
            seen.object = 1 + (hit.on.instance == kNone ? hit.on.shape : hit.on.instance);
            seen.material = 1 + hit.material;
            if (!follows_deltas_) return seen;
        }
        const Bsdf bsdf = world_.bsdf(hit, sample.spectra, sample.kept);
        const auto number = [&](std::uint32_t what) { return sample.numbers(Dimension::of_camera_vertex(i, what)); };
        BsdfSample next;
        if (!bsdf.is_delta() || i == max_deltas_) {
            if (dispersed) passed = SampledSpectrum(passed[sample.kept]);
            seen.albedo = xyz_of(passed * bsdf.albedo(), sample.spectra.wavelengths);
            const Vec3f n = face_forward(bsdf.normal(), -d);
            seen.normal = {rounded(n.x), rounded(n.y), rounded(n.z)};
            return seen;
        }
        if (!bsdf.sample(-d, true, number(Dimension::kLobe), number(Dimension::kDirectionU), number(Dimension::kDirectionV), next,
                         passed)) {
            return seen;
        }
        passed *= next.eta2;  // that radiance is compressed is no loss
        dispersed = dispersed || bsdf.disperses(-d, next.wi);
        at = hit.interaction();
        d = next.wi;
    }
}

}  // namespace latent::render
