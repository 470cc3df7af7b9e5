#include "tools/convert/glare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "base/option_parts.h"
#include "base/parse.h"
#include "color/observer.h"
#include "image/fourier.h"
#include "tools/convert/source.h"

namespace latent::convert {
namespace {

constexpr int kPattern = 2048;  // cells along a side of an aperture and its pattern

using Plane = std::vector<float>;

// How much of each cell is open. `open` says it of the cell at x, y.
template <class Open>
Plane aperture_plane(const Open& open) {
    Plane plane(static_cast<std::size_t>(kPattern) * kPattern);
    for (int y = 0; y < kPattern; ++y) {
        for (int x = 0; x < kPattern; ++x)
            plane[static_cast<std::size_t>(y) * kPattern + static_cast<std::size_t>(x)] =
                static_cast<float>(open(x - kPattern / 2, y - kPattern / 2));
    }
    return plane;
}

// `diameter`: of the circle, on which the corners between blades lie, in cells.
Plane blades_plane(const Glare& glare, double diameter) {
    const image::BladeOpening opening(glare.blades, diameter / 2);
    return aperture_plane([&](int x, int y) { return std::clamp(opening.inside(x, -y) + 0.5, 0.0, 1.0); });
}

// The longer side becomes `diameter`.
Result<Plane> picture_plane(const std::filesystem::path& path, double diameter) {
    const Result<image::ExrReader> reader = image::ExrReader::open(path);
    if (!reader) return reader.error();
    const image::Rect& window = reader->image().data_window;
    if (std::max(window.width(), window.height()) > kPattern)
        return Error{ErrorCode::kUnsupported, fmt::format("{}: has {} x {} pixels; an aperture may have {} along a side",
                                                          path.string(), window.width(), window.height(), kPattern)};
    std::vector<float> pixels(3 * window.pixels());
    image::ExrReader::Scratch scratch;
    const auto width = static_cast<std::size_t>(window.width());
    if (Status s = reader->read(window, {&pixels[0], &pixels[window.pixels()], &pixels[2 * window.pixels()]}, width, scratch); !s)
        return s.error();
    const double scale = std::max(window.width(), window.height()) / diameter;
    bool lets_light_pass = false;
    Plane plane = aperture_plane([&](int x, int y) {
        constexpr int kFine = 4;
        double sum = 0;
        for (int i = 0; i < kFine * kFine; ++i) {
            const auto place = [&](int cell, int fine, int length) {
                return static_cast<int>(std::floor((cell + (fine + 0.5) / kFine - 0.5) * scale + length / 2.0));
            };
            const int px = place(x, i % kFine, window.width()), py = place(y, i / kFine, window.height());
            if (px < 0 || py < 0 || px >= window.width() || py >= window.height()) continue;
            const float open = pixels[static_cast<std::size_t>(py) * width + static_cast<std::size_t>(px)];
            if (open > 0) sum += static_cast<double>(std::min(open, 1.0F));
        }
        lets_light_pass = lets_light_pass || sum > 0;
        return sum / (kFine * kFine);
    });
    if (lets_light_pass) return plane;
    return Error{ErrorCode::kOutOfRange, path.string() + ": is black, so no light passes this aperture"};
}

// 1 in the inner half of a pattern, 0 at its edge: rays do not end all at once.
double faded(int x, int y) {
    const double r = 2 * std::sqrt(static_cast<double>(x * x + y * y)) / kPattern, t = std::clamp(2 - 2 * r, 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

// Fraunhofer: the square of the aperture's Fourier transform; adds up to 1 before it is faded.
image::Pattern diffraction(Plane aperture) {
    const image::SquareFourier fourier(kPattern);
    Plane zero(aperture.size());
    fourier.forward(aperture.data(), zero.data());
    double sum = 0;
    for (std::size_t i = 0; i < aperture.size(); ++i) {
        aperture[i] = aperture[i] * aperture[i] + zero[i] * zero[i];
        sum += static_cast<double>(aperture[i]);
    }
    std::vector<int> place(kPattern);  // from the middle
    for (int i = 0; i < kPattern; ++i)
        place[static_cast<std::size_t>(i)] = (fourier.frequency(i) + kPattern / 2) % kPattern - kPattern / 2;
    image::Pattern pattern{kPattern, std::move(zero)};
    for (std::size_t i = 0; i < aperture.size(); ++i) {
        const int x = place[i % kPattern], y = place[i / kPattern];
        pattern.light[static_cast<std::size_t>(y + kPattern / 2) * kPattern + static_cast<std::size_t>(x + kPattern / 2)] =
            static_cast<float>(static_cast<double>(aperture[i]) / sum * faded(x, y));
    }
    return pattern;
}

double to_three_halves(double t) { return t * std::sqrt(t); }

// [CIE135] total glare function, 1/sr, at an angle in degrees: age in years, p = 0.5 (brown eyes).
double eye_spread(double degrees, double age) {
    constexpr double kPigment = 0.5;
    const double a = (age / 70) * (age / 70) * (age / 70) * (age / 70), t2 = degrees * degrees;
    const double wide = 1 + t2 / (0.1 * 0.1);
    return (1 - 0.08 * a) *
               (9.2e6 / to_three_halves(1 + t2 / (0.0046 * 0.0046)) + 1.5e5 / to_three_halves(1 + t2 / (0.045 * 0.045))) +
           (1 + 1.6 * a) * (400 / wide + 3e-8 * t2 + kPigment * (1300 / to_three_halves(wide) + 0.8 / std::sqrt(wide))) +
           2.5e-3 * kPigment;
}

}  // namespace

Result<Glare> parse_glare(std::string_view text) {
    const auto refuse = [&](std::string_view what) {
        return is_not(text, fmt::format("{} (try blades:6,f:8, or f:16, eye, FILE.exr,f:8)", what));
    };
    Glare glare;
    glare.text = text;
    if (Status s = check_parts_differ(text); !s) return s.error();
    const std::vector<std::string_view> parts = parts_of(text, ',');
    glare.eye = parts.front() == "eye";
    const bool picture = parts.front().ends_with(".exr");
    if (picture) glare.aperture = parts.front();
    for (const std::string_view part : std::span(parts).subspan(glare.eye || picture ? 1 : 0)) {
        const std::optional<NamedNumbers> named = named_numbers(part);
        if (!named || named->numbers.empty()) return refuse("a kind of glare");
        if (!glare.eye && !picture && named->name == "blades") {
            const Result<image::Blades> blades = image::parse_blades(*named, part);
            if (!blades) return blades.error();
            glare.blades = *blades;
            continue;
        }
        const double number = named->numbers.front();
        const auto take = [&](double& to, double least, double most) {
            to = number;
            return named->numbers.size() == 1 && number >= least && number <= most;
        };
        if (!glare.eye && named->name == "f") {
            if (!take(glare.f_number, 0.5, 1000)) return is_not(part, "an f-number, 0.5 to 1000 (try f:8)");
        } else if (glare.eye && named->name == "age") {
            if (!take(glare.age, 0, 100)) return is_not(part, "an age, 0 to 100 years (try age:70)");
        } else if (glare.eye && named->name == "field") {
            glare.field.degrees = number;
            if (named->numbers.size() != 1 || !glare.field.is_possible())
                return is_not(part, fmt::format("a field of view, {:g} to {:g} degrees (try field:40)", FieldOfView::kMin,
                                                FieldOfView::kMax));
        } else if (glare.eye) {
            return refuse("a glare: an eye has age and field only");
        } else if (named->name == "age" || named->name == "field") {
            return refuse("a glare: age and field are those of an eye");
        } else if (picture && named->name == "blades") {
            return refuse("a glare: a picture of an aperture needs no blades");
        } else {
            return is_not(part, "part of a glare (try blades:6, f:8)");
        }
    }
    return glare;
}

std::vector<Wavelength> wavelengths_of(const Source& source) {
    constexpr int kFirst = 400, kLast = 700, kStep = 10;
    const bool xyz = !source.reader.image().film && source.xyz_from_file == color::Matrix3{};
    std::vector<Wavelength> out;
    std::array<double, 3> sums{};
    const auto seen = [&](int nm) {
        if (xyz) return color::Observer::cie1931().at(nm);
        return std::array<double, 3>{nm >= 600 ? 1.0 : 0, nm >= 500 && nm < 600 ? 1.0 : 0, nm < 500 ? 1.0 : 0};
    };
    for (int nm = kFirst; nm <= kLast; nm += kStep) {
        for (std::size_t c = 0; c < 3; ++c) sums[c] += seen(nm)[c];
    }
    for (int nm = kFirst; nm <= kLast; nm += kStep) {
        Wavelength& wavelength = out.emplace_back(Wavelength{static_cast<double>(nm), {}});
        for (std::size_t c = 0; c < 3; ++c) wavelength.weights[c] = static_cast<float>(seen(nm)[c] / sums[c]);
    }
    return out;
}

Result<image::Kernel> lens_kernel(const Glare& glare, double pixel_um, const std::vector<Wavelength>& light, int max_radius) {
    // A cell of the pattern is lambda N diameter / kPattern wide: half the width that holds all detail, or less for small pixels.
    const auto cell_um = [&](double nm, double diameter) { return nm / 1000 * glare.f_number * diameter / kPattern; };
    double diameter = kPattern / 2.0;
    while (cell_um(light.front().nm, diameter) > pixel_um && diameter > 64) diameter /= 2;
    Result<Plane> aperture = glare.aperture.empty() ? blades_plane(glare, diameter) : picture_plane(glare.aperture, diameter);
    if (!aperture) return aperture.error();
    const image::Pattern pattern = diffraction(*std::move(aperture));
    const double reach = kPattern / 2.0 * cell_um(light.back().nm, diameter) / pixel_um;
    image::Kernel kernel(std::min(max_radius, static_cast<int>(std::ceil(reach)) + 1));
    for (const Wavelength& wavelength : light)
        image::add_pattern(pattern, cell_um(wavelength.nm, diameter) / pixel_um, wavelength.weights, kernel);
    return kernel;
}

// Light from all places of a pixel to all places of another: the finer, the nearer.
image::Kernel eye_kernel(const Glare& glare, double pixel_degrees, int radius) {
    image::Kernel kernel(radius);
    const double radians = pixel_degrees * std::numbers::pi / 180;
    for (int y = 0; y <= radius; ++y) {
        for (int x = 0; x <= y; ++x) {
            if (y == 0) continue;
            const int fine = y <= 2 ? 64 : y <= 8 ? 16 : y <= 32 ? 4 : 1;
            double sum = 0;
            for (int j = 0; j < fine * fine; ++j) {
                // Over the tent of both pixels: the sum of two places within one.
                const auto offset = [&](int k) { return 2 * (k + 0.5) / fine - 1; };
                const double dx = offset(j % fine), dy = offset(j / fine);
                const double weight = fine == 1 ? 1 : (1 - std::abs(dx)) * (1 - std::abs(dy)) * 4 / (fine * fine);
                const double px = x + dx, py = y + dy;
                sum += weight * eye_spread(std::sqrt(px * px + py * py) * pixel_degrees, glare.age);
            }
            const auto weight = static_cast<float>(sum * radians * radians);
            for (std::size_t c = 0; c < 3; ++c) {
                for (const int sx : {-x, x}) {
                    for (const int sy : {-y, y}) {
                        kernel.set(c, sx, sy, weight);
                        kernel.set(c, sy, sx, weight);
                    }
                }
            }
        }
    }
    return kernel;
}

Result<image::Kernel> glare_kernel(const Glare& glare, const Source& source, double frame_mm, int max_radius) {
    const image::Rect& whole = source.reader.image().display_window;
    const int longer = std::max(whole.width(), whole.height());
    if (glare.eye) return eye_kernel(glare, glare.field.degrees / longer, std::min(max_radius, longer));
    return lens_kernel(glare, pixel_um(source, frame_mm), wavelengths_of(source), max_radius);
}

}  // namespace latent::convert
