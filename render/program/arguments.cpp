#include "render/program/arguments.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>

#include "sampledb/data/parse.h"

namespace latent::render {

namespace {

std::optional<std::uint64_t> parse_count(std::string_view text) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

// "A<separator>B"
std::optional<std::pair<std::uint64_t, std::uint64_t>> parse_pair(std::string_view text, char separator) {
    const std::size_t at = text.find(separator);
    if (at == std::string_view::npos) return std::nullopt;
    const std::optional<std::uint64_t> a = parse_count(text.substr(0, at)), b = parse_count(text.substr(at + 1));
    if (!a || !b) return std::nullopt;
    return std::pair{*a, *b};
}

Error usage(std::string_view option, std::string_view text, std::string_view example) {
    return {ErrorCode::kUsage, fmt::format("{} {}: should look like {}", option, text, example)};
}

}  // namespace

Status parse_ranges(const RangeArguments& arguments, RenderSettings& settings) {
    if (!arguments.samples.empty()) {
        const Result<sampledb::SampleRange> range = sampledb::parse_sample_range(arguments.samples);
        if (!range || range->end > std::uint64_t{1} << 62) return usage("--samples", arguments.samples, "0:1048576 or 0:1M");
        settings.samples = *range;
    }
    if (!arguments.shard.empty()) {
        const auto shard = parse_pair(arguments.shard, '/');
        if (!shard || shard->first >= shard->second || shard->second > 1u << 20)
            return usage("--shard", arguments.shard, "0/4, 1/4, 2/4 or 3/4");
        settings.shard = {shard->first, shard->second};
    }
    if (!arguments.resolution.empty()) {
        const auto size = parse_pair(arguments.resolution, 'x');
        constexpr std::uint64_t kMost = 1u << 24;
        if (!size || size->first == 0 || size->second == 0 || size->first > kMost || size->second > kMost)
            return usage("--resolution", arguments.resolution, "1920x1080");
        settings.resolution = Resolution{static_cast<std::uint32_t>(size->first), static_cast<std::uint32_t>(size->second)};
    }
    if (arguments.depth == "unlimited") {
        settings.max_depth = kUnlimited;
    } else if (!arguments.depth.empty()) {
        const auto depth = parse_count(arguments.depth);
        if (!depth || *depth > 1u << 30) return usage("--max-depth", arguments.depth, "12 or unlimited");
        settings.max_depth = static_cast<std::uint32_t>(*depth);
    }
    return {};
}

}  // namespace latent::render
