#include "render/medium/sum.h"

#include <algorithm>
#include <cmath>

#include "render/medium/phase_mixer.h"

namespace latent::render {

namespace {

Box box_of(const std::vector<SumMedium::Part>& parts) {
    Box box;
    for (const SumMedium::Part& part : parts) {
        if (part.varied) box.add(unit_cube_box(part.unit_from_world.inverse().value_or(Affined{})));
    }
    return box;
}

Affined world_from_unit(const Box& box) {
    const Vec3d size = box.high - box.low;
    return {{size.x, 0, 0}, {0, size.y, 0}, {0, 0, size.z}, box.low};
}

// A box of the sum's unit cube in that of a part: the box about its image.
struct Image {
    Vec3f low, high;
    Image(const Affined& m, const Vec3f& from, const Vec3f& to) {
        const Vec3d middle = m.point(Vec3d(from + to) * 0.5), half = Vec3d(to - from) * 0.5;
        const auto reach = [&](double x, double y, double z) {
            return half.x * std::abs(x) + half.y * std::abs(y) + half.z * std::abs(z);
        };
        const Vec3d size{reach(m.x.x, m.y.x, m.z.x), reach(m.x.y, m.y.y, m.z.y), reach(m.x.z, m.y.z, m.z.z)};
        low = Vec3f(middle - size), high = Vec3f(middle + size);
    }
};

constexpr std::uint32_t kCells = 32;  // along each axis

MajorantGrid majorants_of(const std::vector<SumMedium::Part>& parts, const Affined& world_from_sum, MajorantGrid::Cell outside) {
    const auto max_between = [&](const Vec3f& low, const Vec3f& high) {
        float most = outside.max;
        for (const SumMedium::Part& part : parts) {
            if (!part.varied) continue;
            const Image image(part.unit_from_world * world_from_sum, low, high);
            most += part.max_sigma_t * part.varied->majorants().max_between(image.low, image.high);
        }
        return most * (1 + 1e-5f);
    };
    const auto mean_at = [&](const Vec3f& p) {
        float mean = outside.mean;
        for (const SumMedium::Part& part : parts) {
            if (!part.varied) continue;
            const Vec3f in_part((part.unit_from_world * world_from_sum).point(Vec3d(p)));
            mean += part.mean_sigma_t * part.varied->majorants().mean_at(in_part);
        }
        return mean;
    };
    return {{kCells, kCells, kCells}, max_between, mean_at};
}

MajorantGrid::Cell outside_of(const std::vector<SumMedium::Part>& parts) {
    MajorantGrid::Cell cell{0, 0};
    for (const SumMedium::Part& part : parts) {
        if (part.varied) continue;
        cell.max += part.max_sigma_t * (1 + 1e-5f);
        cell.mean += part.mean_sigma_t;
    }
    return cell;
}

}  // namespace

SumMedium::SumMedium(std::vector<Part> parts, std::uint32_t one) : SumMedium(std::move(parts), one, box_of(parts)) {}

SumMedium::SumMedium(std::vector<Part>&& parts, std::uint32_t one, const Box& box)
    : HeterogeneousMedium(PhaseFunction{}, world_from_unit(box).inverse().value_or(Affined{}), one,
                          majorants_of(parts, world_from_unit(box), outside_of(parts)), outside_of(parts)) {
    for (Part& part : parts) {
        is_bounded_ = is_bounded_ && part.varied;
        is_emissive_ = is_emissive_ || (part.varied ? part.varied->is_emissive() : part.emission != kNone);
        const Affinef unit_from_sum(part.unit_from_world * world_from_unit(box));
        parts_.push_back({std::move(part), unit_from_sum});
    }
}

template <class Visit>
void SumMedium::each_at(const Vec3f& p, Visit visit) const {
    for (const Placed& placed : parts_) {
        if (!placed.part.varied) {
            visit(placed.part, p);
            continue;
        }
        const Vec3f q = placed.unit_from_sum.point(p);
        if (is_in_unit_cube(q)) visit(placed.part, q);
    }
}

void SumMedium::add_up(const Vec3f& p, SampleState& sample, std::uint32_t Part::*constant, Coefficient varied,
                       SampledSpectrum& sum) const {
    sum = SampledSpectrum(0.0f);
    each_at(p, [&](const Part& part, const Vec3f& q) {
        SampledSpectrum own;
        if (part.varied) ((*part.varied).*varied)(q, sample, own);
        sum += part.varied ? own : sample.spectra[part.*constant];
    });
}

void SumMedium::extinction(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_t) const {
    add_up(p, sample, &Part::sigma_t, &HeterogeneousMedium::extinction, sigma_t);
}

void SumMedium::scattering(const Vec3f& p, SampleState& sample, SampledSpectrum& sigma_s) const {
    add_up(p, sample, &Part::sigma_s, &HeterogeneousMedium::scattering, sigma_s);
}

bool SumMedium::emission(const Vec3f& p, SampleState& sample, SampledSpectrum& out) const {
    out = SampledSpectrum(0.0f);
    each_at(p, [&](const Part& part, const Vec3f& q) {
        SampledSpectrum own;
        if (part.varied) {
            if (part.varied->is_emissive() && part.varied->emission(q, sample, own)) out += own;
        } else if (part.emission != kNone) {
            out += sample.spectra[part.emission];
        }
    });
    return !out.is_black();
}

Phase SumMedium::phase(const Vec3f& p, SampleState& sample) const {
    PhaseMixer mixer(sample);
    each_at(unit_point(p), [&](const Part& part, const Vec3f& q) {
        SampledSpectrum own;
        if (part.varied) part.varied->scattering(q, sample, own);
        mixer.add(part.phase, part.varied ? own : sample.spectra[part.sigma_s]);
    });
    return mixer.phase();
}

}  // namespace latent::render
