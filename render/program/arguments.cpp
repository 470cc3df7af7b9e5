#include "render/program/arguments.h"

#include <algorithm>

#include "base/parse.h"
#include "sampledb/data/parse.h"

namespace latent::render {

Result<Shard> parse_shard(std::string_view text) {
    const auto shard = parse_pair(text, '/');
    if (shard && shard->first < shard->second && shard->second <= 1u << 20) return Shard{shard->first, shard->second};
    return is_not(text, "a shard (try 0/4, 1/4, 2/4 and 3/4)");
}

Result<Resolution> parse_resolution(std::string_view text) {
    constexpr std::uint64_t kMax = 1u << 24;
    const auto size = parse_pair(text, 'x');
    if (size && size->first > 0 && size->second > 0 && size->first <= kMax && size->second <= kMax)
        return Resolution{static_cast<std::uint32_t>(size->first), static_cast<std::uint32_t>(size->second)};
    return is_not(text, "a resolution (try 1920x1080)");
}

Result<std::array<double, 2>> parse_shutter(std::string_view text) {
    const std::size_t colon = std::min(text.find(':'), text.size());
    const Result<double> open = parse_number(text.substr(0, colon)),
                         close = parse_number(text.substr(std::min(colon + 1, text.size())));
    if (open && close && 0 <= *open && *open < *close && *close <= 1e6) return std::array{*open, *close};
    return is_not(text, "a range of seconds (try 0:0.02)");
}

Result<std::uint32_t> parse_depth(std::string_view text) {
    if (text == "unlimited") return kUnlimited;
    const Result<std::uint64_t> depth = parse_count(text);
    if (depth && *depth <= 1u << 30) return static_cast<std::uint32_t>(*depth);
    return is_not(text, "a depth (try 12 or unlimited)");
}

Result<NoiseTarget> parse_noise_target(std::string_view text) {
    constexpr std::uint64_t kMaxWidth = 1u << 23;
    const std::size_t at = std::min(text.find('@'), text.size());
    const std::string_view percent = text.substr(0, at), width = text.substr(std::min(at + 1, text.size()));
    const Result<double> number = parse_number(percent.substr(0, percent.find('%')));
    const Result<std::uint64_t> pixels = at == text.size() ? Result<std::uint64_t>(0) : parse_count(width);
    const bool sized = at == text.size() || (pixels && *pixels > 0 && *pixels <= kMaxWidth);
    if (percent.ends_with('%') && number && *number >= 1e-4 && *number <= 1000 && sized)
        return NoiseTarget{*number / 100, static_cast<std::uint32_t>(*pixels)};
    return is_not(text, "a noise (try 2%, or 2%@1920 for a picture 1920 pixels wide)");
}

Result<sampledb::SampleRange> parse_samples(std::string_view text) {
    const Result<sampledb::SampleRange> range = sampledb::parse_sample_range(text);
    if (range && range->end > std::uint64_t{1} << 62) return is_not(text, "a range of samples below 2^62");
    return range;
}

}  // namespace latent::render
