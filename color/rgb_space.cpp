#include "color/rgb_space.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/parse.h"

namespace latent::color {
namespace {

constexpr Chromaticity kD65{0.3127, 0.3290};

struct KnownSpace {
    std::string_view name;
    Primaries primaries;
    Transfer transfer;
};

const std::vector<KnownSpace>& known_spaces() {
    static const std::vector<KnownSpace> known = {
        {"srgb", {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, kD65}, Transfer::srgb()},                     // [IEC61966-2-1]
        {"display-p3", {{0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, kD65}, Transfer::srgb()},         // [EG432-1]
        {"rec2020", {{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, kD65}, Transfer::rec2020()},         // [BT2020]
        {"adobe-rgb", {{0.64, 0.33}, {0.21, 0.71}, {0.15, 0.06}, kD65}, Transfer::gamma(563.0 / 256.0)},  // [AdobeRGB]
    };
    return known;
}

Error out_of_range(std::string_view space, std::string_view what) {
    return Error{ErrorCode::kOutOfRange, fmt::format("RGB space {}: {}", space, what)};
}

}  // namespace

bool are_xyz(const Primaries& p) {
    const auto near = [](Chromaticity a, Chromaticity b) { return std::abs(a.x - b.x) < 1e-4 && std::abs(a.y - b.y) < 1e-4; };
    const Primaries& xyz = kXyzPrimaries;
    return near(p.red, xyz.red) && near(p.green, xyz.green) && near(p.blue, xyz.blue) && near(p.white, xyz.white);
}

Chromaticities chromaticities_of(const Primaries& p) {
    const auto f = [](double v) { return static_cast<float>(v); };
    return {f(p.red.x), f(p.red.y), f(p.green.x), f(p.green.y), f(p.blue.x), f(p.blue.y), f(p.white.x), f(p.white.y)};
}

Primaries primaries_of(const Chromaticities& chromaticities) {
    std::array<double, 8> c;
    std::ranges::copy(chromaticities, c.begin());
    return {{c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}, {c[6], c[7]}};
}

Result<RgbSpace> RgbSpace::parse(std::string_view text) {
    std::string choices;
    for (const KnownSpace& known : known_spaces()) {
        if (known.name == text) return from_primaries(std::string(text), known.primaries, known.transfer);
        choices += fmt::format("{}, ", known.name);
    }
    if (const auto numbers = parse_numbers(text); numbers && numbers->size() == 8) {
        const std::vector<double>& v = *numbers;
        return from_primaries(std::string(text), {{v[0], v[1]}, {v[2], v[3]}, {v[4], v[5]}, {v[6], v[7]}}, Transfer::srgb());
    }
    return usage_error(fmt::format("\"{}\" is not an RGB space; choose {}or 8 numbers rx,ry,gx,gy,bx,by,wx,wy", text, choices));
}

std::vector<std::string> RgbSpace::names() {
    std::vector<std::string> out;
    for (const KnownSpace& known : known_spaces()) out.emplace_back(known.name);
    return out;
}

const RgbSpace& RgbSpace::srgb() {
    static const RgbSpace space = *parse("srgb");
    return space;
}

Result<RgbSpace> RgbSpace::from_primaries(std::string name, const Primaries& p, const Transfer& transfer) {
    if (!(p.red.y != 0 && p.green.y != 0 && p.blue.y != 0 && p.white.y != 0)) {
        return out_of_range(name, "a chromaticity with y = 0 has no luminance; give its matrix instead");
    }
    // Columns are the primaries at unknown amounts; white decides: columns * amounts = white.
    const Xyz r = xyz_from_chromaticity(p.red), g = xyz_from_chromaticity(p.green), b = xyz_from_chromaticity(p.blue);
    const Xyz w = xyz_from_chromaticity(p.white);
    Matrix3 columns{{{{r.x, g.x, b.x}, {r.y, g.y, b.y}, {r.z, g.z, b.z}}}};
    if (!columns.invertible()) return out_of_range(name, "the primaries lie on a line, so they span no gamut");
    const auto amounts = columns.inverse() * std::array{w.x, w.y, w.z};
    Matrix3 xyz_from_rgb;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) xyz_from_rgb.m[i][j] = columns.m[i][j] * amounts[j];
    }
    if (!xyz_from_rgb.invertible()) return out_of_range(name, "its white does not use one of the primaries");
    return RgbSpace{std::move(name), p, transfer, xyz_from_rgb.inverse(), xyz_from_rgb, xyz_from_rgb.m[1]};
}

Result<RgbSpace> RgbSpace::from_matrix(std::string name, const Matrix3& rgb_from_xyz, const std::array<double, 3>* luminance_row,
                                       const Transfer& transfer) {
    RgbSpace space{std::move(name), {}, transfer, rgb_from_xyz, Matrix3{{}}, {}};
    const bool invertible = rgb_from_xyz.invertible();
    if (!invertible && luminance_row == nullptr) {
        return out_of_range(space.name,
                            "its matrix is singular, so the luminance of red, green and blue must be given (--luminance-row)");
    }
    if (invertible) space.xyz_from_rgb = rgb_from_xyz.inverse();
    space.luminance_row = luminance_row != nullptr ? *luminance_row : space.xyz_from_rgb.m[1];
    const double white_y = space.luminance_row[0] + space.luminance_row[1] + space.luminance_row[2];
    if (!(std::isfinite(white_y) && white_y > 0)) return out_of_range(space.name, "its white has no luminance");
    for (double& value : space.luminance_row) value /= white_y;
    space.rgb_from_xyz = rgb_from_xyz * white_y;
    space.xyz_from_rgb = space.xyz_from_rgb * (1 / white_y);
    if (invertible) {
        const auto xy_of = [&](std::array<double, 3> rgb) {
            const auto xyz = space.xyz_from_rgb * rgb;
            return chromaticity({xyz[0], xyz[1], xyz[2]});
        };
        space.primaries = {xy_of({1, 0, 0}), xy_of({0, 1, 0}), xy_of({0, 0, 1}), xy_of({1, 1, 1})};
    }
    return space;
}

Status RgbSpace::check_luminance_row() const {
    constexpr std::string_view kPrimary[] = {"red", "green", "blue"};
    for (int i = 0; i < 3; ++i) {
        if (!(luminance_row[i] >= -1e-6)) {
            return out_of_range(name,
                                fmt::format("the {} primary has the negative luminance {:.6f}, so luminance cannot be preserved; "
                                            "use --gamut clip or other primaries",
                                            kPrimary[i], luminance_row[i]));
        }
    }
    return {};
}

}  // namespace latent::color
