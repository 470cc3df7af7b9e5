#include "tools/convert/white.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parse.h"
#include "color/light_name.h"
#include "color/named_spectra.h"
#include "color/observer.h"
#include "tools/convert/source.h"

namespace latent::convert {

using color::Chromaticity;
using image::Rect;

namespace {

Chromaticity rounded(Chromaticity white) { return {std::round(white.x * 1e4) / 1e4, std::round(white.y * 1e4) / 1e4}; }

Chromaticity chromaticity_of_light(const color::Spectrum& light) {
    return rounded(color::chromaticity(color::xyz_from_spectrum(light, color::Observer::cie1931())));
}

Result<White> white_of_temperature(const std::string& text) {
    const Result<double> kelvin = color::parse_temperature(text);
    if (!kelvin) return kelvin.error();
    if (*kelvin >= color::kDaylightKelvin) return White{rounded(*color::daylight_chromaticity(*kelvin))};
    return White{chromaticity_of_light(*color::Spectrum::blackbody(*kelvin))};
}

// X,Y,WIDTH,HEIGHT; nothing unless these are whole numbers and the pixels have coordinates.
std::optional<Rect> rectangle_of(const std::vector<double>& numbers) {
    constexpr double kLimit = (1 << 30) - 1;
    const auto whole = [](double v) { return v == std::floor(v) && std::abs(v) <= kLimit; };
    if (!std::ranges::all_of(numbers, whole) || numbers[2] < 1 || numbers[3] < 1) return std::nullopt;
    const int x = static_cast<int>(numbers[0]), y = static_cast<int>(numbers[1]);
    return Rect{x, y, x + static_cast<int>(numbers[2]), y + static_cast<int>(numbers[3])};
}

}  // namespace

Result<White> parse_white(const std::string& text) {
    if (const auto numbers = parse_numbers(text)) {
        if (numbers->size() == 2) return White{Chromaticity{(*numbers)[0], (*numbers)[1]}};
        if (numbers->size() == 4) {
            if (const auto area = rectangle_of(*numbers)) return White{*area};
        }
    }
    if (text == "E") return White{rounded({1.0 / 3, 1.0 / 3})};
    if (const auto light = color::named_spectrum("stdillum-" + text)) return White{chromaticity_of_light(*light)};
    const bool temperature = text.size() > 1 && (text.back() == 'K' || text.back() == 'k') && text.find(',') == std::string::npos;
    if (temperature) return white_of_temperature(text);
    return is_not(text, "a white (try D65, D50, A, E, F1 to F12, 5200K, a chromaticity x,y, or pixels X,Y,WIDTH,HEIGHT)");
}

// Row by row from the top: the sum, and so the print, does not depend on threads or memory.
Result<Chromaticity> chromaticity_of(const White& white, const Source& source) {
    if (const auto* given = std::get_if<Chromaticity>(&white)) return *given;
    const Rect area = std::get<Rect>(white);
    const Rect& has = source.reader.image().data_window;
    const std::string where = fmt::format("{},{},{},{}", area.x0, area.y0, area.width(), area.height());
    if (!has.contains(area)) {
        return usage_error(fmt::format("{}: has pixels {},{} to {},{}; --white {} is not inside", source.reader.path().string(),
                                       has.x0, has.y0, has.x1, has.y1, where));
    }
    constexpr std::size_t kPixelsAtOnce = std::size_t{1} << 20;
    const std::size_t width = static_cast<std::size_t>(area.width());
    const int rows = static_cast<int>(std::clamp(kPixelsAtOnce / width, std::size_t{1}, static_cast<std::size_t>(area.height())));
    std::vector<float> planes(3 * width * static_cast<std::size_t>(rows));
    image::ExrReader::Scratch scratch;
    std::array<double, 3> sum{};
    for (int y = area.y0; y < area.y1; y += rows) {
        const Rect strip{area.x0, y, area.x1, std::min(y + rows, area.y1)};
        const std::size_t pixels = strip.pixels();
        const std::array<float*, 3> to{planes.data(), planes.data() + pixels, planes.data() + 2 * pixels};
        if (Status s = source.reader.read(strip, to, width, scratch); !s) return s.error();
        for (std::size_t i = 0; i < pixels; ++i) {
            if (!std::ranges::all_of(to, [i](const float* plane) { return std::isfinite(plane[i]); })) continue;
            for (std::size_t c = 0; c < 3; ++c) sum[c] += static_cast<double>(to[c][i]);
        }
    }
    const std::array<double, 3> xyz = source.xyz_from_file * sum;
    if (!std::ranges::all_of(xyz, [](double v) { return v > 0; })) {
        return Error{ErrorCode::kOutOfRange, fmt::format("{}: --white {}: the pixels have no light, so they cannot be white",
                                                         source.reader.path().string(), where)};
    }
    return rounded(color::chromaticity({xyz[0], xyz[1], xyz[2]}));
}

std::string text_of(Chromaticity white) { return fmt::format("{:.6g},{:.6g}", white.x, white.y); }

}  // namespace latent::convert
