#include "tools/develop/channels/channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "base/parse.h"
#include "tools/develop/channels/rows.h"

namespace latent::develop {

namespace {

constexpr double kLumensPerWatt = 683;  // K_m [CIE15]
constexpr std::uint64_t kMaxTableBytes = std::uint64_t{8} << 20;

std::optional<std::size_t> group_column(const sampledb::Job& job) {
    const auto column = std::ranges::find(job.extra, kLightGroupColumn, &sampledb::ExtraColumnSpec::name);
    if (column == job.extra.end()) return std::nullopt;
    return static_cast<std::size_t>(column - job.extra.begin());
}

}  // namespace

void Channels::see_through(std::shared_ptr<const color::Observer> observer, GroupLight& light) const {
    light.observer = std::move(observer);
    if (kind_ == sampledb::RecordKind::kSpectral && !density_.empty() &&
        BatchResponse::bytes(density_, batch_, *light.observer) <= kMaxTableBytes)
        light.response = BatchResponse(density_, batch_, *light.observer);
}

Status Channels::add_layers(const sampledb::Job& job, const Layers& layers) {
    Result<AovColumns> aovs = AovColumns::find(job, layers);
    if (!aovs) return aovs.error();
    aovs_ = *aovs;
    layout_.layers = layers;
    return {};
}

Status Channels::mix_lights(const sampledb::Job& job, const std::vector<GroupFactor>& factors) {
    group_column_ = group_column(job);
    if (!group_column_) return {};
    const GroupLight plain = lights_[0];
    lights_.assign(factors.size() + 1, plain);
    for (std::size_t i = 0; i < factors.size(); ++i) {
        GroupLight& light = lights_[i];
        light.factor = static_cast<float>(factors[i].factor);
        if (!factors[i].curve) continue;
        if (kind_ == sampledb::RecordKind::kXyz)
            return usage_error("--light: spectra and filters need spectral records; these hold XYZ, so only factors are possible");
        light.curve = factors[i].curve;
        if (bins_ > 0) continue;
        see_through(std::make_shared<const color::Observer>(plain.observer->behind(*light.curve, "curve", 1)), light);
    }
    return {};
}

void Channels::show_lights(const sampledb::Job& job, std::vector<std::string> names) {
    group_column_ = group_column(job);
    layout_.lights = std::move(names);
}

Status Channels::weigh(const sampledb::Job& job, const LensChoice& choice) {
    if (choice.is_whole()) return {};
    Result<LensWeights> weights = LensWeights::make(job, choice);
    if (!weights) return weights.error();
    lens_ = *std::move(weights);
    return {};
}

Status Channels::use_ratio() {
    if (kind_ == sampledb::RecordKind::kXyz) return usage_error("--estimator ratio: needs spectral records; these hold XYZ");
    Result<BatchWhite> white = BatchWhite::make(density_, batch_, *lights_[0].observer);
    if (!white) return white.error();
    white_ = std::move(*white);
    layout_.ratio = true;
    return {};
}

Result<Channels> Channels::xyz(const sampledb::Job& job, const color::Observer* observer) {
    Channels channels;
    channels.kind_ = job.kind;
    channels.batch_ = job.batch;
    channels.density_ = job.density;
    channels.see_through(observer != nullptr ? std::make_shared<const color::Observer>(*observer) : nullptr, channels.lights_[0]);
    return channels;
}

Result<SpectralBins> parse_spectral_bins(std::string_view text) {
    constexpr int kMax = 470;
    SpectralBins bins;
    const auto refuse = [&](std::string_view what) {
        return usage_error(fmt::format("'{}': {} (try 94, or 400:700:10)", text, what));
    };
    if (text.find(':') == std::string_view::npos) {
        const Result<std::uint64_t> count = parse_count(text);
        if (!count || *count < 1 || *count > kMax) return refuse(fmt::format("not a number of bins from 1 to {}", kMax));
        bins.count = static_cast<int>(*count);
        return bins;
    }
    std::string with_commas(text);
    std::ranges::replace(with_commas, ':', ',');
    const auto numbers = parse_numbers(with_commas);
    if (!numbers || numbers->size() != 3) return refuse("not from:to:step in nm");
    bins.from_nm = (*numbers)[0];
    bins.to_nm = (*numbers)[1];
    if (bins.from_nm >= bins.to_nm) return refuse("the range must begin below its end");
    if (!(bins.from_nm >= color::kLambdaMin && bins.to_nm <= color::kLambdaMax))
        return refuse(fmt::format("the range must lie within {} to {} nm", color::kLambdaMin, color::kLambdaMax));
    const double count = (bins.to_nm - bins.from_nm) / (*numbers)[2];
    if (!(count > 0.5 && count < kMax + 0.5)) return refuse(fmt::format("1 to {} bins are possible", kMax));
    if (std::abs(count - std::round(count)) > 1e-6) return refuse("the range is not a whole number of steps");
    bins.count = static_cast<int>(std::round(count));
    return bins;
}

Result<Channels> Channels::spectral_bins(const sampledb::Job& job, const SpectralBins& bins) {
    if (job.kind != sampledb::RecordKind::kSpectral) {
        return usage_error("--spectral-bins: needs spectral records; these hold XYZ");
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
    sampledb::ExtraSet extra = aovs_.columns();
    if (group_column_) extra.set(*group_column_);
    if (lens_) extra |= lens_->columns();
    return {.samples = layout_.layers.by_sample() || layout_.layers.halves, .extra = extra};
}

std::size_t Channels::group_of(const sampledb::Page& page, std::size_t row) const {
    if (!group_column_) return 0;
    const sampledb::ExtraColumn& column = page.extra[*group_column_];
    const std::size_t bytes = sampledb::width(column.type);
    std::size_t group = 0;
    for (std::size_t i = bytes; i-- > 0;) group = group << 8 | static_cast<std::size_t>(column.values[row * bytes + i]);
    return group;
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

// Makes one row of those of a sample, and fills the entries that are of samples.
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
            const auto move = [&](int entry) { first[entry] += std::exchange(other[entry], 0.0f); };
            for (int entry = 0; entry < layout_.filled(); ++entry) move(entry);
            for (int entry = layout_.light(0); entry < layout_.albedo(); ++entry) move(entry);
        }
        if (layout_.layers.variance && camera) {
            for (int c = 0; c < n; ++c) {
                const float divisor = first[layout_.divisor(c)];
                first[layout_.squares() + c] = first[c] * first[c];
                first[layout_.products() + c] = first[c] * divisor;
                first[layout_.divisor_square(c)] = divisor * divisor;
            }
        }
        if (layout_.layers.count && camera && (!lens_ || first[layout_.share()] != 0)) first[layout_.counter()] = 1;
        row = next;
    }
}

// The entries of half 0: all of them again, or zeros.
void Channels::fill_halves(const sampledb::Page& page, std::size_t begin, std::size_t end, float* out) const {
    for (std::size_t row = begin; row < end; ++row, out += stride()) {
        const float factor = half_of(page.sample[row]) == 0 ? 1 : 0;  // a branch would be mispredicted for every second row
        const auto fill = [out, factor](int from, int to, int count) {
            for (int i = 0; i < count; ++i) out[to + i] = factor * out[from + i];
        };
        fill(0, layout_.half(), layout_.linear());
        for (std::size_t group = 0; group < layout_.lights.size(); ++group)
            fill(layout_.light(group), layout_.light_half(group), layout_.light_values());
    }
}

std::uint64_t Channels::values(const sampledb::Page& page, std::size_t begin, std::size_t end, float* out) const {
    const std::uint64_t not_finite = light_rows(page, begin, end, out);
    if (layout_.layers.aovs()) aovs_.fill(page, begin, end, layout_, out);
    if (layout_.layers.by_sample()) complete_rows(page, begin, end, out);
    if (layout_.layers.halves) fill_halves(page, begin, end, out);
    return not_finite;
}

// The light of rows, by groups too, and what divides it; zeros behind. Returns what `values` does.
std::uint64_t Channels::light_rows(const sampledb::Page& page, std::size_t begin, std::size_t end, float* out) const {
    const bool camera = page.record_class == sampledb::RecordClass::kCamera;
    const int step = stride(), n = count();
    thread_local LensWeights::Factors factors;
    const bool weighed = lens_ && lens_->weighs(page.record_class);
    if (weighed) lens_->factors(page, begin, end, factors);
    if (kind_ == sampledb::RecordKind::kXyz && !group_column_ && (!camera || page.unit_share)) {
        thread_local std::vector<float> fours;
        fours.resize(step == 4 ? 0 : 4 * (end - begin));
        float* const rows = step == 4 ? out : fours.data();
        if (interleave_rows(std::span(page.x).subspan(begin, end - begin), &page.y[begin], &page.z[begin], camera ? 1.0f : 0.0f,
                            weighed ? RowFactors{factors.value.data(), factors.share.data()} : RowFactors{}, rows)) {
            for (std::size_t i = 0; i < fours.size(); i += 4, out += step)
                std::fill(std::copy_n(&fours[i], 4, out), out + step, 0.0f);
            return 0;
        }
    }
    std::uint64_t not_finite = 0;
    for (std::size_t row = begin; row < end; ++row, out += step) {
        std::fill(out, out + step, 0.0f);
        const float lens_value = weighed ? factors.value[row - begin] : 1;
        if (lens_value == 0) continue;
        float share = sampledb::share_of(page, row) * (weighed ? factors.share[row - begin] : 1);
        const std::size_t group = group_of(page, row);
        const GroupLight& light = lights_[std::min(group, lights_.size() - 1)];
        if (kind_ == sampledb::RecordKind::kXyz) {
            out[0] = page.x[row];
            out[1] = page.y[row];
            out[2] = page.z[row];
        } else {
            spectral_row(light, page, row, out);
        }
        if (const float factor = light.factor * lens_value; factor != 1)
            std::for_each(out, out + n, [&](float& value) { value *= factor; });
        float check = share;  // times zero: 0 if all are finite, else NaN
        for (int c = 0; c < n; ++c) check += out[c] * 0.0f;
        if (!std::isfinite(check)) {
            ++not_finite;
            std::fill(out, out + n, 0.0f);
            if (!std::isfinite(share)) share = 0;
        }
        out[n] = share;
        if (group < layout_.lights.size()) std::copy_n(out, n, out + layout_.light(group));
        if (white_ && share > 0) {
            const std::array<float, 3> white = (*white_)(page.xi[row]);
            for (int c = 0; c < n; ++c) out[layout_.divisor(c)] = share * white[static_cast<std::size_t>(c)];
        }
    }
    return not_finite;
}

}  // namespace latent::develop
