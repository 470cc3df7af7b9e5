#include "tools/develop/channels.h"

#include <fmt/format.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "base/parse.h"
#include "tools/develop/rows.h"

namespace latent::develop {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr double kLumensPerWatt = 683;  // K_m [CIE15]
constexpr std::uint64_t kMaxTableBytes = std::uint64_t{8} << 20;
constexpr int kGuide = 1024;

// Knots of f(Q^-1(q)) in q, sorted: those of Q and those of the observer.
std::vector<double> knots_in_q(const sampledb::WavelengthDensity& density, const color::Observer& observer) {
    const auto knots = density.knots();
    std::vector<double> q;
    for (const auto& knot : knots) q.push_back(static_cast<double>(knot.cumulative) * 0x1p-48);
    for (const double nm : observer.lambda_nm()) {
        const double lambda = nm * 0x1p20;
        const auto above =
            std::ranges::upper_bound(knots, lambda, {}, [](const auto& knot) { return static_cast<double>(knot.lambda); });
        if (above == knots.begin() || above == knots.end()) continue;
        const auto below = above - 1;
        const double part = (lambda - below->lambda) / (static_cast<double>(above->lambda) - below->lambda);
        q.push_back((static_cast<double>(below->cumulative) + part * static_cast<double>(above->cumulative - below->cumulative)) *
                    0x1p-48);
    }
    std::ranges::sort(q);
    return q;
}

// Where in xi (units of 2^-32) the sum over a batch of k stops being linear.
std::vector<double> breaks_in_xi(const sampledb::WavelengthDensity& density, int k, const color::Observer& observer) {
    std::vector<double> breaks = {0};
    for (const double q : knots_in_q(density, observer)) {
        const double place = q * k;
        breaks.push_back((place - std::floor(place)) * 0x1p32);
    }
    std::ranges::sort(breaks);
    std::vector<double> distinct;
    for (const double b : breaks) {  // an interval without a whole xi is none
        if (!distinct.empty() && std::ceil(b) == std::ceil(distinct.back())) distinct.pop_back();
        if (std::ceil(b) < 0x1p32) distinct.push_back(b);
    }
    return distinct;
}

double wavelength_nm(const sampledb::WavelengthDensity& density, double q) {
    const auto knots = density.knots();
    const double target = q * 0x1p48;
    auto above = std::ranges::upper_bound(knots, target, {}, [](const auto& knot) { return static_cast<double>(knot.cumulative); });
    above = std::clamp(above, knots.begin() + 1, knots.end() - 1);
    const auto below = above - 1;
    const double part =
        (target - static_cast<double>(below->cumulative)) / static_cast<double>(above->cumulative - below->cumulative);
    return (below->lambda + part * (static_cast<double>(above->lambda) - below->lambda)) * 0x1p-20;
}

std::array<double, 3> response(const color::Observer& observer, double nm) {
    const auto lambda = observer.lambda_nm();
    const auto f = observer.responses();
    if (nm < lambda.front() || nm > lambda.back()) return {};
    const std::size_t above = std::clamp<std::size_t>(std::ranges::upper_bound(lambda, nm) - lambda.begin(), 1, lambda.size() - 1);
    const double part = (nm - lambda[above - 1]) / (lambda[above] - lambda[above - 1]);
    std::array<double, 3> value;
    for (int c = 0; c < 3; ++c) value[c] = f[above - 1][c] + part * (f[above][c] - f[above - 1][c]);
    return value;
}

}  // namespace

BatchResponse::BatchResponse(const sampledb::WavelengthDensity& density, int k, const color::Observer& observer) : k_(k) {
    const std::vector<double> breaks = breaks_in_xi(density, k, observer);
    const std::size_t groups = (k + 3) / 4;
    table_.assign(breaks.size() * groups * kGroupFloats, 0.0f);
    for (std::size_t r = 0; r < breaks.size(); ++r) {
        const double begin = breaks[r], end = r + 1 < breaks.size() ? breaks[r + 1] : 0x1p32;
        rows_.push_back({static_cast<std::uint32_t>(std::ceil(begin)), begin, 1 / (end - begin)});
        for (int i = 0; i < k; ++i) {  // a line through two inner points, for curves may jump at their ends
            const auto at = [&](double t) {
                return response(observer, wavelength_nm(density, ((begin + t * (end - begin)) * 0x1p-32 + i) / k));
            };
            const std::array<double, 3> low = at(0.25), high = at(0.75);
            float* group = &table_[(r * groups + i / 4) * kGroupFloats + i % 4];
            for (int c = 0; c < 3; ++c) {
                const double step = 2 * (high[c] - low[c]);
                group[8 * c] = static_cast<float>(low[c] - 0.25 * step);
                group[8 * c + 4] = static_cast<float>(step);
            }
        }
    }
    std::size_t row = 0;
    for (int g = 0; g < kGuide; ++g) {
        while (row + 1 < rows_.size() && rows_[row + 1].first_xi <= static_cast<std::uint32_t>(g) << 22) ++row;
        guide_.push_back(static_cast<std::uint32_t>(row));
    }
}

std::uint64_t BatchResponse::bytes(const sampledb::WavelengthDensity& density, int k, const color::Observer& observer) {
    return (density.knots().size() + observer.lambda_nm().size()) * ((std::uint64_t(k) + 3) / 4) * kGroupFloats * sizeof(float);
}

void BatchResponse::xyz(std::uint32_t xi, const float* power, float* out) const {
    std::size_t row = guide_[xi >> 22];
    while (row + 1 < rows_.size() && rows_[row + 1].first_xi <= xi) ++row;
    const std::size_t groups = (static_cast<std::size_t>(k_) + 3) / 4;
    const float* group = &table_[row * groups * kGroupFloats];

    // Four partial sums on every processor, added in one order.
    const hn::FixedTag<float, 4> d;
    const auto t = hn::Set(d, static_cast<float>((xi - rows_[row].begin) * rows_[row].scale));
    auto x = hn::Zero(d), y = x, z = x;
    const auto add = [&](auto p) {
        x = hn::Add(x, hn::Mul(p, hn::Add(hn::LoadU(d, group), hn::Mul(t, hn::LoadU(d, group + 4)))));
        y = hn::Add(y, hn::Mul(p, hn::Add(hn::LoadU(d, group + 8), hn::Mul(t, hn::LoadU(d, group + 12)))));
        z = hn::Add(z, hn::Mul(p, hn::Add(hn::LoadU(d, group + 16), hn::Mul(t, hn::LoadU(d, group + 20)))));
    };
    int i = 0;
    for (; i + 4 <= k_; i += 4, group += kGroupFloats) add(hn::LoadU(d, power + i));
    if (i < k_) {
        float last[4] = {};
        std::copy(power + i, power + k_, last);
        add(hn::LoadU(d, last));
    }
    const auto sum = [&](auto v) {
        float s[4];
        hn::StoreU(v, d, s);
        return (s[0] + s[1]) + (s[2] + s[3]);
    };
    out[0] = sum(x);
    out[1] = sum(y);
    out[2] = sum(z);
}

void Channels::see_through(const color::Observer* observer, GroupLight& light) const {
    light.observer = observer;
    if (kind_ == sampledb::RecordKind::kSpectral && !density_.empty() &&
        BatchResponse::bytes(density_, batch_, *observer) <= kMaxTableBytes)
        light.response = BatchResponse(density_, batch_, *observer);
}

Status Channels::mix_lights(const sampledb::Job& job, const std::vector<GroupFactor>& factors) {
    const auto column = std::ranges::find(job.extra, kLightGroupColumn, &sampledb::ExtraColumnSpec::name);
    if (column == job.extra.end() || factors.empty()) return {};
    group_column_ = static_cast<std::size_t>(column - job.extra.begin());
    const GroupLight plain = lights_[0];
    lights_.assign(factors.size() + 1, plain);
    for (std::size_t i = 0; i < factors.size(); ++i) {
        GroupLight& light = lights_[i];
        light.factor = static_cast<float>(factors[i].factor);
        if (!factors[i].curve) continue;
        if (kind_ == sampledb::RecordKind::kXyz)
            return Error{ErrorCode::kUsage,
                         "--light: spectra and filters need spectral records; these hold XYZ, so only factors are possible"};
        light.curve = factors[i].curve;
        if (bins_ > 0) continue;
        light.own = std::make_shared<const color::Observer>(plain.observer->behind(*light.curve, "curve", 1));
        see_through(light.own.get(), light);
    }
    return {};
}

Result<Channels> Channels::xyz(const sampledb::Job& job, const color::Observer* observer) {
    Channels channels;
    channels.kind_ = job.kind;
    channels.batch_ = job.batch;
    channels.density_ = job.density;
    channels.see_through(observer, channels.lights_[0]);
    return channels;
}

Result<SpectralBins> parse_spectral_bins(std::string_view text) {
    constexpr int kMost = 470;
    SpectralBins bins;
    const auto refuse = [&](std::string_view what) {
        return Error{ErrorCode::kUsage, fmt::format("'{}': {} (try 94, or 400:700:10)", text, what)};
    };
    if (text.find(':') == std::string_view::npos) {
        const Result<std::uint64_t> count = parse_count(text);
        if (!count || *count < 1 || *count > kMost) return refuse(fmt::format("not a number of bins from 1 to {}", kMost));
        bins.count = static_cast<int>(*count);
        return bins;
    }
    std::string with_commas(text);
    std::ranges::replace(with_commas, ':', ',');
    const auto numbers = parse_numbers(with_commas);
    if (!numbers || numbers->size() != 3) return refuse("not from:to:step in nm");
    bins.from_nm = (*numbers)[0];
    bins.to_nm = (*numbers)[1];
    if (!(bins.from_nm >= color::kLambdaMin && bins.to_nm <= color::kLambdaMax && bins.from_nm < bins.to_nm))
        return refuse(fmt::format("the range must lie within {} to {} nm", color::kLambdaMin, color::kLambdaMax));
    const double count = (bins.to_nm - bins.from_nm) / (*numbers)[2];
    if (!(count > 0.5 && count < kMost + 0.5)) return refuse(fmt::format("1 to {} bins are possible", kMost));
    if (std::abs(count - std::round(count)) > 1e-6) return refuse("the range is not a whole number of steps");
    bins.count = static_cast<int>(std::round(count));
    return bins;
}

Result<Channels> Channels::spectral_bins(const sampledb::Job& job, const SpectralBins& bins) {
    if (job.kind != sampledb::RecordKind::kSpectral) {
        return Error{ErrorCode::kUsage, "--spectral-bins: needs spectral records; these hold XYZ"};
    }
    Channels channels;
    channels.kind_ = job.kind;
    channels.batch_ = job.batch;
    channels.density_ = job.density;
    channels.layout_.channels = channels.bins_ = bins.count;
    channels.bins_from_ = static_cast<float>(bins.from_nm);
    channels.bins_to_ = static_cast<float>(bins.to_nm);
    channels.bins_per_nm_ = static_cast<float>(bins.count) / (channels.bins_to_ - channels.bins_from_);
    // A luminance of Y light units is 683 times the integral of ybar times the radiance in watts.
    channels.bin_scale_ = static_cast<float>(job.light_unit_cd_m2 / kLumensPerWatt / bins.width_nm());
    return channels;
}

sampledb::ColumnSet Channels::columns() const {
    return {.samples = layout_.layers.by_sample() || layout_.layers.halves, .extra = group_column_.has_value()};
}

const Channels::GroupLight& Channels::light_of(const sampledb::Page& page, std::size_t row) const {
    if (!group_column_) return lights_[0];
    const sampledb::ExtraColumn& column = page.extra[*group_column_];
    const std::size_t bytes = sampledb::width(column.type);
    std::size_t group = 0;
    for (std::size_t i = bytes; i-- > 0;) group = group << 8 | static_cast<std::size_t>(column.values[row * bytes + i]);
    return lights_[std::min(group, lights_.size() - 1)];
}

void Channels::add_pair(const GroupLight& light, float lambda_nm, float power, float* out) const {
    if (!std::isfinite(lambda_nm)) {
        out[0] = lambda_nm;  // found by `values`
        return;
    }
    if (bins_ > 0) {
        const float place = (lambda_nm - bins_from_) * bins_per_nm_;
        if (place < 0 || lambda_nm > bins_to_) return;
        if (light.curve) power *= static_cast<float>((*light.curve)(static_cast<double>(lambda_nm)));
        out[std::min(static_cast<int>(place), bins_ - 1)] += power * bin_scale_;
        return;
    }
    const std::array<float, 3> f = (*light.observer)(lambda_nm);
    for (int c = 0; c < 3; ++c) out[c] += power * f[c];
}

void Channels::spectral_row(const GroupLight& light, const sampledb::Page& page, std::size_t row, float* out) const {
    const std::size_t n = page.pairs[row];
    const float* power = page.power.data() + page.first_pair[row];
    if (n == static_cast<std::size_t>(batch_) && !light.response.empty()) return light.response.xyz(page.xi[row], power, out);
    std::array<float, sampledb::kMaxPairs> lambda;
    sampledb::wavelengths_of(density_, static_cast<std::size_t>(batch_), page, row, std::span(lambda).first(n));
    for (std::size_t i = 0; i < n; ++i) add_pair(light, lambda[i], power[i], out);
}

// The lanes behind the share.
void Channels::complete_rows(const sampledb::Page& page, std::size_t begin, std::size_t end, float* out) const {
    const bool camera = page.record_class == sampledb::RecordClass::kCamera;
    const int step = stride(), n = count();
    const auto same = [&](std::size_t a, std::size_t b) {
        return page.sample[a] == page.sample[b] && page.u[a] == page.u[b] && page.v[a] == page.v[b];
    };
    for (std::size_t row = begin; row < end;) {
        float* const first = out + static_cast<std::ptrdiff_t>(row - begin) * step;
        std::size_t next = row + 1;
        for (; (camera ? layout_.layers.by_sample() : layout_.layers.samples) && next < end && same(row, next); ++next) {
            float* const other = out + static_cast<std::ptrdiff_t>(next - begin) * step;
            for (int lane = 0; lane <= n; ++lane) first[lane] += std::exchange(other[lane], 0.0f);
        }
        if (layout_.layers.halves && half_of(page.sample[row]) == 0) std::copy_n(first, layout_.linear(), first + layout_.half());
        if (layout_.layers.variance && camera) {
            const float share = first[n];
            for (int c = 0; c < n; ++c) {
                first[layout_.squares() + c] = first[c] * first[c];
                first[layout_.products() + c] = first[c] * share;
            }
            first[layout_.share_square()] = share * share;
        }
        if (layout_.layers.count && camera) first[layout_.counter()] = 1;
        row = next;
    }
}

std::uint64_t Channels::values(const sampledb::Page& page, std::size_t begin, std::size_t end, float* out) const {
    const bool camera = page.record_class == sampledb::RecordClass::kCamera;
    const int step = stride(), n = count();
    float* const rows = out;
    if (step == 4 && !layout_.layers.samples && !group_column_ && kind_ == sampledb::RecordKind::kXyz &&
        (!camera || page.unit_share) &&
        interleave_rows(std::span(page.x).subspan(begin, end - begin), &page.y[begin], &page.z[begin], camera ? 1.0f : 0.0f, out)) {
        return 0;
    }
    std::uint64_t not_finite = 0;
    for (std::size_t row = begin; row < end; ++row, out += step) {
        float share = sampledb::share_of(page, row);
        const GroupLight& light = light_of(page, row);
        std::fill(out, out + step, 0.0f);
        if (kind_ == sampledb::RecordKind::kXyz) {
            out[0] = page.x[row];
            out[1] = page.y[row];
            out[2] = page.z[row];
        } else {
            spectral_row(light, page, row, out);
        }
        if (light.factor != 1) std::for_each(out, out + n, [&](float& value) { value *= light.factor; });
        float check = share;  // times zero: 0 if all are finite, else NaN
        for (int c = 0; c < n; ++c) check += out[c] * 0.0f;
        if (!std::isfinite(check)) {
            ++not_finite;
            std::fill(out, out + n, 0.0f);
            if (!std::isfinite(share)) share = 0;
        }
        out[n] = share;
    }
    if (step > layout_.linear() || layout_.layers.samples) complete_rows(page, begin, end, rows);
    return not_finite;
}

}  // namespace latent::develop
