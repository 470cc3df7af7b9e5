#include "tools/convert/glare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parse.h"
#include "color/observer.h"
#include "image/fourier.h"
#include "tools/convert/source.h"

namespace latent::convert {
namespace {

constexpr int kPattern = 2048;  // cells along a side of an aperture and its pattern

// Cosine and sine of 2 pi `turns`, by Taylor's series within an eighth of a turn: the same bits everywhere, to 1e-15.
std::array<double, 2> unit_vector(double turns) {
    turns -= std::floor(turns);
    const double quarters = std::floor(4 * turns + 0.5);
    const double x = 2 * std::numbers::pi * (turns - quarters / 4);
    double cosine = 0, sine = 0, term = 1;
    for (int i = 0; i < 20; i += 2) {
        cosine += term;
        term *= x / (i + 1);
        sine += term;
        term *= -x / (i + 2);
    }
    switch (static_cast<int>(quarters) & 3) {
        case 1:
            return {-sine, cosine};
        case 2:
            return {-cosine, -sine};
        case 3:
            return {sine, -cosine};
        default:
            return {cosine, sine};
    }
}

using Plane = std::vector<float>;

// Of the aperture at x, y: how much of a cell is open.
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

// `diameter`: of a circle of the same area, in cells.
Plane blades_plane(const Glare& glare, double diameter) {
    const double radius = diameter / 2;
    const auto covered = [](double inside) { return std::clamp(inside + 0.5, 0.0, 1.0); };
    if (glare.blades == 0)
        return aperture_plane([&](int x, int y) { return covered(radius - std::sqrt(static_cast<double>(x * x + y * y))); });
    // Area of n sides at distance h from the centre: n h^2 tan(pi / n).
    std::vector<std::array<double, 2>> normals;
    for (int i = 0; i < glare.blades; ++i)
        normals.push_back(unit_vector(static_cast<double>(i) / glare.blades + glare.rotation / 360 + 0.25));
    const std::array<double, 2> half = unit_vector(0.5 / glare.blades);
    const double distance = radius * std::sqrt(std::numbers::pi * half[0] / (half[1] * glare.blades));
    return aperture_plane([&](int x, int y) {
        double inside = distance;
        for (const auto& n : normals) inside = std::min(inside, distance - (n[0] * x + n[1] * y));
        return covered(inside);
    });
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
    const std::string shown(text);
    const auto refuse = [&](std::string_view why) {
        return usage_error(fmt::format("'{}': {} (try blades:6,f:8, or f:16, eye, FILE.exr,f:8)", shown, why));
    };
    Glare glare;
    glare.text = shown;
    bool lens = false, field = false;
    for (bool first = true; first || !text.empty(); first = false) {
        const std::size_t comma = text.find(',');
        const std::string_view word = text.substr(0, comma);
        text = comma == std::string_view::npos ? std::string_view{} : text.substr(comma + 1);
        const std::size_t colon = word.find(':');
        const std::string_view name = word.substr(0, colon);
        if (colon == std::string_view::npos) {
            if (!first || word.empty()) return refuse("not a kind of glare");
            if (word == "eye") {
                glare.eye = true;
            } else if (word.ends_with(".exr")) {
                glare.aperture = word;
            } else {
                return refuse("not a kind of glare");
            }
            continue;
        }
        const Result<double> number = parse_number(word.substr(colon + 1));
        if (!number) return refuse(fmt::format("{} needs a number", name));
        const auto within = [&](double least, double most) { return *number >= least && *number <= most; };
        if (name == "f" && within(0.5, 1000)) {
            glare.f_number = *number;
            lens = true;
        } else if (name == "blades" && within(3, 64) && *number == std::floor(*number)) {
            glare.blades = static_cast<int>(*number);
            lens = true;
        } else if (name == "rotation" && within(-360, 360)) {
            glare.rotation = *number;
            lens = true;
        } else if (name == "age" && within(0, 100)) {
            glare.age = *number;
            field = true;
        } else if (name == "field" && within(0.1, 150)) {
            glare.field = *number;
            field = true;
        } else if (name == "f") {
            return refuse("f-numbers are 0.5 to 1000");
        } else if (name == "blades") {
            return refuse("an aperture has 3 to 64 blades");
        } else if (name == "rotation" || name == "age" || name == "field") {
            return refuse(fmt::format("{} is out of range", name));
        } else {
            return refuse(fmt::format("{} is not known", name));
        }
    }
    if (glare.eye && lens) return refuse("an eye has age and field only");
    if (!glare.eye && field) return refuse("age and field are those of an eye");
    if (!glare.aperture.empty() && glare.blades > 0) return refuse("a picture of an aperture needs no blades");
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

Result<image::Kernel> lens_kernel(const Glare& glare, double pixel_um, const std::vector<Wavelength>& light, int most_radius) {
    // A cell of the pattern is lambda N diameter / kPattern wide: half the width that holds all detail, or less for small pixels.
    const auto cell_um = [&](double nm, double diameter) { return nm / 1000 * glare.f_number * diameter / kPattern; };
    double diameter = kPattern / 2.0;
    while (cell_um(light.front().nm, diameter) > pixel_um && diameter > 64) diameter /= 2;
    Result<Plane> aperture = glare.aperture.empty() ? blades_plane(glare, diameter) : picture_plane(glare.aperture, diameter);
    if (!aperture) return aperture.error();
    const image::Pattern pattern = diffraction(*std::move(aperture));
    const double reach = kPattern / 2.0 * cell_um(light.back().nm, diameter) / pixel_um;
    image::Kernel kernel(std::min(most_radius, static_cast<int>(std::ceil(reach)) + 1));
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

Result<image::Kernel> glare_kernel(const Glare& glare, const Source& source, double frame_mm, int most_radius) {
    const image::Rect& whole = source.reader.image().display_window;
    const int longer = std::max(whole.width(), whole.height());
    if (glare.eye) return eye_kernel(glare, glare.field / longer, std::min(most_radius, longer));
    return lens_kernel(glare, pixel_um(source, frame_mm), wavelengths_of(source), most_radius);
}

}  // namespace latent::convert
