#include "render/transport/records.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace latent::render {
namespace {

// True if every value is a number that light can have; else counts the cause.
bool is_valid(const SampledSpectrum& power, RadianceFaults& faults) {
    int invalid = 0;
    for (const float v : power.v) invalid |= static_cast<int>(!(v >= 0)) | static_cast<int>(v == INFINITY);
    if (invalid == 0) return true;
    const auto any = [&](auto is) { return std::any_of(std::begin(power.v), std::end(power.v), is); };
    ++(any([](float v) { return std::isnan(v); })   ? faults.nan
       : any([](float v) { return std::isinf(v); }) ? faults.infinite
                                                    : faults.negative);
    return false;
}

SampledSpectrum only_at(const SampledSpectrum& value, std::uint32_t i) {
    SampledSpectrum out(0.0f);
    out[i] = value[i];
    return out;
}

}  // namespace

RecordMaker::RecordMaker(sampledb::RecordKind kind, const LightGroups& groups, const AovSettings& aovs)
    : kind_(kind), groups_(groups), aovs_(aovs) {
    if (groups.any()) columns_.push_back({kLightGroupColumn, sampledb::ColumnType::kU8, {}});
    for (const sampledb::ExtraColumnSpec& column : aov_columns(aovs)) columns_.push_back({column.name, column.type, {}});
    for (std::size_t c = 0; c < 3; ++c) {
        const color::IntegerNmSpectrum curve = color::sampled_at_integer_nm(color::Observer::cie1931().curve(static_cast<int>(c)));
        for (std::size_t i = 0; i < observer_.size(); ++i) observer_[i][c] = curve.value[i];
    }
}

void SampleRecords::camera(std::uint32_t u, std::uint32_t v, const Radiance& radiance, const Seen& seen, std::uint32_t only) {
    put_groups({sampledb::RecordClass::kCamera, u, v, only}, radiance, seen);
}

void SampleRecords::light(const CameraPoint& point, const Radiance& radiance) {
    const Seen seen{.lens = point.lens, .time = sample_.numbers(Dimension::kTime)};
    const auto put_at = [&](float u, float v, std::uint32_t only) {
        const auto fixed = [](float x) { return static_cast<std::uint32_t>(x * 0x1p32f); };
        put_groups({sampledb::RecordClass::kLight, fixed(u), fixed(v), only}, radiance, seen);
    };
    if (!camera_.splits_wavelengths()) return put_at(point.u, point.v, kAllWavelengths);
    const Wavelengths& w = sample_.spectra.wavelengths;
    for (std::uint32_t i = 0; i < w.k; ++i) {
        const auto defocus = static_cast<float>(camera_.defocus(static_cast<double>(w.lambda_nm[i])));
        const Vec2f spread = camera_.spread(point.lens);
        const float u = point.u + spread.x * defocus, v = point.v + spread.y * defocus;
        if (u >= 0 && u < 1 && v >= 0 && v < 1) put_at(u, v, i);
    }
}

void SampleRecords::put_groups(const Place& place, const Radiance& radiance, const Seen& seen) {
    const Wavelengths& w = sample_.spectra.wavelengths;
    const bool camera = place.record_class == sampledb::RecordClass::kCamera, all = place.only == kAllWavelengths;
    float share = !camera ? 0.0f : all ? 1.0f : 1 / static_cast<float>(w.k);  // share of the first record at the position
    bool any = false;
    for (std::uint32_t group = 0; group < radiance.groups(); ++group) {
        const RadianceSum& sum = radiance.of(group);
        SampledSpectrum power = sum.sum * w.weight;
        if (!all) power = only_at(power, place.only);
        if (!is_valid(power, out_.faults) || power.is_black()) continue;
        put(place, std::exchange(share, 0.0f), &power, sum.has_all && all);
        put_extra(group, seen);
        any = true;
    }
    if (any || !camera) return;
    put(place, share, nullptr, false);
    put_extra(0, seen);
}

void SampleRecords::put_extra(std::uint32_t group, const Seen& seen) {
    if (maker_.columns_.empty()) return;
    std::vector<sampledb::ExtraColumn>& extra = out_.records.extra;
    if (extra.empty()) extra = maker_.columns_;
    const bool with_groups = maker_.groups_.any();
    if (with_groups) extra[0].values.push_back(static_cast<std::byte>(group));
    append(maker_.aovs_, seen, std::span(extra).subspan(with_groups ? 1 : 0));
}

void SampleRecords::put(const Place& place, float share, const SampledSpectrum* power, bool has_all) {
    const Wavelengths& w = sample_.spectra.wavelengths;
    sampledb::Records& out = out_.records;
    out.sample.push_back(sample_.numbers.sample());
    out.record_class.push_back(place.record_class);
    out.u.push_back(place.u);
    out.v.push_back(place.v);
    out.share.push_back(share);
    if (maker_.kind_ == sampledb::RecordKind::kXyz) {
        std::array<float, 4> xyz{};
        for (std::uint32_t i = 0; power && i < w.k; ++i) {
            const std::array<float, 4>&a = maker_.observer_[w.below[i]], &b = maker_.observer_[w.below[i] + 1];
            for (std::size_t c = 0; c < 4; ++c) xyz[c] += (*power)[i] * (a[c] + w.fraction[i] * (b[c] - a[c]));
        }
        out.x.push_back(xyz[0]);
        out.y.push_back(xyz[1]);
        out.z.push_back(xyz[2]);
        return;
    }
    out.xi.push_back(w.xi);
    if (!power) {
        out.pairs.push_back(0);
        out.index.push_back(sampledb::kNoIndex);
    } else if (has_all || w.k == 1) {
        out.pairs.push_back(static_cast<std::uint16_t>(w.k));
        out.index.push_back(sampledb::kNoIndex);
        out.power.insert(out.power.end(), power->v, power->v + w.k);
    } else {
        const std::uint32_t kept = place.only == kAllWavelengths ? sample_.kept : place.only;
        out.pairs.push_back(1);
        out.index.push_back(static_cast<std::uint16_t>(kept));
        out.power.push_back((*power)[kept]);
    }
}

}  // namespace latent::render
