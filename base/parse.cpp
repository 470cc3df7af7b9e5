#include "base/parse.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace latent {

namespace {

// What "K", "Mi" and so on stand for, with `kilo` (1000 or 1024) for units without an i; "" is 1.
std::optional<std::uint64_t> unit_value(std::string_view unit, std::uint64_t kilo) {
    if (unit.empty()) return 1;
    const bool binary = unit.size() == 2 && (unit[1] == 'i' || unit[1] == 'I');
    const std::size_t place = std::string_view("KMGTkmgt").find(unit[0]);
    if (place == std::string_view::npos || (unit.size() > 1 && !binary)) return std::nullopt;
    std::uint64_t value = 1;
    for (std::size_t i = 0; i <= place % 4; ++i) value *= binary ? 1024 : kilo;
    return value;
}

// Takes what from_chars understands from the front of `text`; nothing if that is no number, or one too large.
template <class Number>
std::optional<Number> take(std::string_view& text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc()) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return value;
}

// "1e6": exact below 2^53.
std::optional<std::uint64_t> parse_power_of_ten(std::string_view text) {
    const std::optional<double> value = text.starts_with('-') ? std::nullopt : take<double>(text);
    if (!value || !text.empty() || *value > 0x1p53 || *value != std::floor(*value)) return std::nullopt;
    return static_cast<std::uint64_t>(*value);
}

std::optional<std::uint64_t> parse_whole(std::string_view text, std::uint64_t kilo) {
    if (text.find_first_of("eE") != std::string_view::npos) return parse_power_of_ten(text);
    const std::optional<std::uint64_t> whole = take<std::uint64_t>(text);
    if (!whole) return std::nullopt;
    double fraction = 0;
    const bool has_fraction = text.starts_with('.');
    if (has_fraction) {
        const std::size_t end = std::min(text.find_first_not_of("0123456789", 1), text.size());
        std::string_view digits = text.substr(0, end);
        const std::optional<double> value = take<double>(digits);
        if (!value) return std::nullopt;
        fraction = *value;
        text.remove_prefix(end);
    }
    const std::optional<std::uint64_t> unit = unit_value(text, kilo);
    if (!unit || (has_fraction && text.empty())) return std::nullopt;
    // Exact to the unit: a fraction has an error below 2^-53, a unit is at most 2^40.
    const auto rest = static_cast<std::uint64_t>(std::llround(fraction * static_cast<double>(*unit)));
    std::uint64_t value = 0;
    if (__builtin_mul_overflow(*whole, *unit, &value) || __builtin_add_overflow(value, rest, &value)) return std::nullopt;
    return value;
}

}  // namespace

Error is_not(std::string_view text, std::string_view what) { return usage_error(fmt::format("'{}' is not {}", text, what)); }

Result<std::uint64_t> parse_count(std::string_view text) {
    if (const auto value = parse_whole(text, 1000)) return *value;
    return is_not(text, "a count (try 8, 1.5M or 64Ki)");
}

Result<std::uint64_t> parse_size(std::string_view text) {
    if (const auto value = parse_whole(text, 1024)) return *value;
    return is_not(text, "a size in bytes (try 512M or 1.5G)");
}

Result<double> parse_number(std::string_view text) {
    std::string_view rest = text;
    const std::optional<double> number = take<double>(rest);
    const std::optional<std::uint64_t> unit = unit_value(rest, 1000);
    const double value = number && unit ? *number * static_cast<double>(*unit) : HUGE_VAL;
    if (!std::isfinite(value)) return is_not(text, "a number");
    return value;
}

Result<double> parse_duration(std::string_view text) {
    const Error error = is_not(text, "a time above 0 (try 90s, 10m or 1h30m)");
    double seconds = 0, longer = HUGE_VAL;  // the unit before
    for (std::string_view rest = text; !rest.empty() || text.empty();) {
        const std::optional<double> number = rest.starts_with('-') ? std::nullopt : take<double>(rest);
        if (!number || (rest.empty() && longer != HUGE_VAL)) return error;  // no unit: seconds, and nothing before
        const std::size_t place = rest.empty() ? 0 : std::string_view("smhd").find(rest[0]);
        if (place == std::string_view::npos) return error;
        const double unit = std::array{1.0, 60.0, 3600.0, 86400.0}[place];
        if (unit >= longer) return error;
        longer = unit;
        seconds += *number * unit;
        rest.remove_prefix(std::min<std::size_t>(rest.size(), 1));
    }
    if (!std::isfinite(seconds) || seconds <= 0) return error;
    return seconds;
}

std::optional<std::pair<std::uint64_t, std::uint64_t>> parse_pair(std::string_view text, char separator) {
    const std::size_t at = text.find(separator);
    if (at == std::string_view::npos) return std::nullopt;
    const auto first = parse_whole(text.substr(0, at), 1000), second = parse_whole(text.substr(at + 1), 1000);
    if (!first || !second) return std::nullopt;
    return std::pair{*first, *second};
}

std::optional<std::vector<double>> parse_numbers(std::string_view text) {
    std::vector<double> numbers;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find(',', at), text.size());
        const Result<double> number = parse_number(text.substr(at, end - at));
        if (!number) return std::nullopt;
        numbers.push_back(*number);
        at = end + 1;
    }
    return numbers;
}

Result<std::array<std::int32_t, 4>> parse_crop(std::string_view text) {
    const std::optional<std::vector<double>> numbers = parse_numbers(text);
    const auto is_pixel = [](double x) { return x == std::floor(x) && std::abs(x) <= std::numeric_limits<std::int32_t>::max(); };
    if (numbers && numbers->size() == 4 && std::ranges::all_of(*numbers, is_pixel)) {
        std::array<std::int32_t, 4> crop{};
        std::ranges::transform(*numbers, crop.begin(), [](double x) { return static_cast<std::int32_t>(x); });
        if (crop[0] < crop[2] && crop[1] < crop[3]) return crop;
    }
    return is_not(text, "a rectangle of pixels X0,Y0,X1,Y1, ends exclusive (try 0,0,512,512)");
}

}  // namespace latent
