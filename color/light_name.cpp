#include "color/light_name.h"

#include <fmt/format.h>

#include "base/parse.h"
#include "color/named_spectra.h"

namespace latent::color {

bool is_temperature(std::string_view text) {
    return text.size() > 1 && (text.back() == 'K' || text.back() == 'k') &&
           text.find_first_not_of("0123456789.") == text.size() - 1 && parse_number(text.substr(0, text.size() - 1));
}

Result<double> parse_temperature(std::string_view text) {
    const Result<double> kelvin = is_temperature(text) ? parse_number(text.substr(0, text.size() - 1)) : Result<double>(0);
    if (kelvin && *kelvin >= kMinKelvin && *kelvin <= kMaxKelvin) return kelvin;
    return is_not(text, fmt::format("a temperature from {:.0f}K to {:.0f}K", kMinKelvin, kMaxKelvin));
}

Result<Spectrum> light_by_name(std::string_view text) {
    if (text == "E") return Spectrum::constant(1);
    if (!is_temperature(text)) return named_spectrum(fmt::format("stdillum-{}", text));
    const Result<double> kelvin = parse_temperature(text);
    if (!kelvin) return kelvin.error();
    return *kelvin >= kDaylightKelvin ? daylight(*kelvin) : Spectrum::blackbody(*kelvin);
}

std::span<const NamedLight> named_lights() {
    static constexpr NamedLight kLights[] = {{"A", "incandescent, 2856 K"},
                                             {"D50", "daylight of prints, 5003 K"},
                                             {"D65", "daylight of displays, 6504 K"},
                                             {"E", "equal energy"},
                                             {"F1", "daylight fluorescent, 6430 K"},
                                             {"F2", "cool white fluorescent, 4230 K"},
                                             {"F3", "white fluorescent, 3450 K"},
                                             {"F4", "warm white fluorescent, 2940 K"},
                                             {"F5", "daylight fluorescent, 6350 K"},
                                             {"F6", "light white fluorescent, 4150 K"},
                                             {"F7", "broad-band fluorescent, 6500 K"},
                                             {"F8", "broad-band fluorescent, 5000 K"},
                                             {"F9", "broad-band cool white fluorescent, 4150 K"},
                                             {"F10", "three-band fluorescent, 5000 K"},
                                             {"F11", "three-band fluorescent, 4000 K"},
                                             {"F12", "three-band fluorescent, 3000 K"}};
    return kLights;
}

}  // namespace latent::color
