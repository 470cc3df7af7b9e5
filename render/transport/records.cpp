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

const Seen kNothingSeen;  // by a light record

}  // namespace

RecordMaker::RecordMaker(sampledb::RecordKind kind, bool with_groups, const AovSettings& aovs)
    : kind_(kind), with_groups_(with_groups), aovs_(aovs) {
    if (with_groups) columns_.push_back({kLightGroupColumn, sampledb::ColumnType::kU8, {}});
    for (const sampledb::ExtraColumnSpec& column : aov_columns(aovs)) columns_.push_back({column.name, column.type, {}});
    for (std::size_t c = 0; c < 3; ++c) {
        const color::IntegerNmSpectrum curve = color::sampled_at_integer_nm(color::Observer::cie1931().curve(static_cast<int>(c)));
        for (std::size_t i = 0; i < observer_.size(); ++i) observer_[i][c] = curve.value[i];
    }
}

void RecordMaker::camera(std::uint64_t n, std::uint32_t u, std::uint32_t v, const Radiance& radiance, const Seen& seen,
                         const Wavelengths& w, std::uint32_t kept, sampledb::Records& out, RadianceFaults& faults,
                         std::uint32_t only) const {
    put_groups(n, u, v, sampledb::RecordClass::kCamera, radiance, seen, w, kept, only, out, faults);
}

void RecordMaker::light(std::uint64_t n, float u, float v, const Radiance& radiance, const Wavelengths& w, std::uint32_t kept,
                        sampledb::Records& out, RadianceFaults& faults, std::uint32_t only) const {
    put_groups(n, static_cast<std::uint32_t>(u * 0x1p32f), static_cast<std::uint32_t>(v * 0x1p32f), sampledb::RecordClass::kLight,
               radiance, kNothingSeen, w, kept, only, out, faults);
}

void RecordMaker::put_groups(std::uint64_t n, std::uint32_t u, std::uint32_t v, sampledb::RecordClass record_class,
                             const Radiance& radiance, const Seen& seen, const Wavelengths& w, std::uint32_t kept,
                             std::uint32_t only, sampledb::Records& out, RadianceFaults& faults) const {
    const bool camera = record_class == sampledb::RecordClass::kCamera, all = only == kAllWavelengths;
    float share = !camera ? 0.0f : all ? 1.0f : 1 / static_cast<float>(w.k);  // of the first record of the position
    bool any = false;
    const auto fill_extra = [&](std::uint32_t group) {
        if (columns_.empty()) return;
        if (out.extra.empty()) out.extra = columns_;
        if (with_groups_) out.extra[0].values.push_back(static_cast<std::byte>(group));
        append(aovs_, seen, std::span(out.extra).subspan(with_groups_ ? 1 : 0));
    };
    for (std::uint32_t group = 0; group < radiance.groups(); ++group) {
        const RadianceSum& sum = radiance.of(group);
        SampledSpectrum power = sum.sum * w.weight;
        if (!all) power = only_at(power, only);
        if (!is_valid(power, faults) || power.is_black()) continue;
        put(n, u, v, record_class, std::exchange(share, 0.0f), sum.has_all && all, &power, w, all ? kept : only, out);
        fill_extra(group);
        any = true;
    }
    if (any || !camera) return;
    put(n, u, v, record_class, share, false, nullptr, w, kept, out);
    fill_extra(0);
}

// `power`: null for a black record.
void RecordMaker::put(std::uint64_t n, std::uint32_t u, std::uint32_t v, sampledb::RecordClass record_class, float share,
                      bool has_all, const SampledSpectrum* power, const Wavelengths& w, std::uint32_t kept,
                      sampledb::Records& out) const {
    out.sample.push_back(n);
    out.record_class.push_back(record_class);
    out.u.push_back(u);
    out.v.push_back(v);
    out.share.push_back(share);
    if (kind_ == sampledb::RecordKind::kXyz) {
        std::array<float, 4> xyz{};
        for (std::uint32_t i = 0; power && i < w.k; ++i) {
            const std::array<float, 4>&a = observer_[w.below[i]], &b = observer_[w.below[i] + 1];
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
        out.pairs.push_back(1);
        out.index.push_back(static_cast<std::uint16_t>(kept));
        out.power.push_back((*power)[kept]);
    }
}

}  // namespace latent::render
