#include "image/spectral_channel.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/parse.h"

namespace latent::image {
namespace {

constexpr double kMetresPerSecond = 299792458;

// A unit's prefix as a power of ten.
std::optional<int> exponent_of(std::string_view prefix) {
    constexpr std::pair<std::string_view, int> kPrefixes[] = {{"Y", 24}, {"Z", 21}, {"E", 18}, {"P", 15}, {"T", 12}, {"G", 9},
                                                              {"M", 6},  {"k", 3},  {"h", 2},  {"da", 1}, {"", 0},   {"d", -1},
                                                              {"c", -2}, {"m", -3}, {"u", -6}, {"n", -9}, {"p", -12}};
    for (const auto& [name, exponent] : kPrefixes) {
        if (name == prefix) return exponent;
    }
    return std::nullopt;
}

std::optional<double> wavelength_nm(std::string_view text) {
    const std::size_t digits = text.find_first_not_of("0123456789,.eE+-");
    if (digits == 0 || digits == std::string_view::npos) return std::nullopt;
    std::string number(text.substr(0, digits));
    std::ranges::replace(number, ',', '.');
    std::string_view unit = text.substr(digits);
    const bool frequency = unit.ends_with("Hz");
    if (!frequency && !unit.ends_with("m")) return std::nullopt;
    unit.remove_suffix(frequency ? 2 : 1);
    const std::optional<int> exponent = exponent_of(unit);
    const Result<double> value = parse_number(number);
    if (!exponent || !value || !(*value > 0)) return std::nullopt;
    const double nm = frequency ? kMetresPerSecond / *value * std::pow(10, 9 - *exponent) : *value * std::pow(10, 9 + *exponent);
    return std::isfinite(nm) && nm > 0 ? std::optional(nm) : std::nullopt;
}

}  // namespace

std::optional<double> emitted_wavelength_nm(std::string_view channel) {
    return channel.starts_with("S0.") ? wavelength_nm(channel.substr(3)) : std::nullopt;
}

bool is_reflectance(std::string_view channel) { return channel.starts_with("T.") && wavelength_nm(channel.substr(2)).has_value(); }

}  // namespace latent::image
