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

Result<sampledb::SampleRange> parse_samples(std::string_view text) {
    const Result<sampledb::SampleRange> range = sampledb::parse_sample_range(text);
    if (range && range->end > std::uint64_t{1} << 62) return is_not(text, "a range of samples below 2^62");
    return range;
}

}  // namespace latent::render
