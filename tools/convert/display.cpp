#include "tools/convert/display.h"

#include <cmath>
#include <filesystem>

#include "base/parse.h"
#include "tools/convert/icc.h"
#include "tools/convert/lcms.h"

namespace latent::convert {

namespace {

// 9 numbers with commas between them.
std::optional<color::Matrix3> matrix_of(const std::string& text) {
    const auto numbers = parse_numbers(text);
    if (!numbers || numbers->size() != 9) return std::nullopt;
    color::Matrix3 matrix;
    for (std::size_t i = 0; i < 9; ++i) matrix.m[i / 3][i % 3] = (*numbers)[i];
    return matrix;
}

// Code points of primaries and white [H273, table 2].
struct KnownPrimaries {
    std::uint8_t code;
    color::Primaries primaries;
};
constexpr color::Chromaticity kD65{0.3127, 0.3290}, kIlluminantC{0.310, 0.316}, kDciWhite{0.314, 0.351};
constexpr KnownPrimaries kKnownPrimaries[] = {
    {1, {{0.640, 0.330}, {0.300, 0.600}, {0.150, 0.060}, kD65}},
    {4, {{0.670, 0.330}, {0.210, 0.710}, {0.140, 0.080}, kIlluminantC}},
    {5, {{0.640, 0.330}, {0.290, 0.600}, {0.150, 0.060}, kD65}},
    {6, {{0.630, 0.340}, {0.310, 0.595}, {0.155, 0.070}, kD65}},
    {8, {{0.681, 0.319}, {0.243, 0.692}, {0.145, 0.049}, kIlluminantC}},
    {9, {{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, kD65}},
    {11, {{0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, kDciWhite}},
    {12, {{0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, kD65}},
    {22, {{0.630, 0.340}, {0.295, 0.605}, {0.155, 0.077}, kD65}},
};

bool near(const color::Primaries& a, const color::Primaries& b) {
    constexpr double kDigit = 5e-5;  // half of the last digit that anybody gives
    const auto same = [](color::Chromaticity p, color::Chromaticity q) {
        return std::abs(p.x - q.x) < kDigit && std::abs(p.y - q.y) < kDigit;
    };
    return same(a.red, b.red) && same(a.green, b.green) && same(a.blue, b.blue) && same(a.white, b.white);
}

// Code points of a space: primaries, transfer, no matrix (RGB), full range. None if H.273 has no such primaries, or if the transfer
// is not that of sRGB: Rec.2020's code point names the curve of its cameras, and Chromium takes it for a display with gamma 2.4,
// which contradicts the profile.
std::optional<std::array<std::uint8_t, 4>> code_points_of(const color::RgbSpace& space) {
    if (space.transfer != color::Transfer::srgb()) return std::nullopt;
    for (const KnownPrimaries& known : kKnownPrimaries) {
        if (near(space.primaries, known.primaries)) return std::array<std::uint8_t, 4>{known.code, 13, 0, 1};
    }
    return std::nullopt;
}

}  // namespace

Result<Display> display_from(const std::string& text, const std::optional<std::array<double, 3>>& luminance_row,
                             const Rendering& rendering) {
    const std::string extension = std::filesystem::path(text).extension().string();
    if (extension == ".icc" || extension == ".icm" || extension == ".ICC" || extension == ".ICM")
        return display_from_icc(text, luminance_row, rendering);
    const std::array<double, 3>* m = luminance_row ? &*luminance_row : nullptr;
    const std::optional<color::Matrix3> matrix = matrix_of(text);
    Result<color::RgbSpace> space =
        matrix ? color::RgbSpace::from_matrix(text, *matrix, m, color::Transfer::srgb()) : color::RgbSpace::parse(text);
    if (space && m != nullptr && !matrix)
        space = color::RgbSpace::from_matrix(space->name, space->rgb_from_xyz, m, space->transfer);
    if (!space) return usage_error(space.error().message).at("--profile");  // impossible numbers are wrong usage too
    Display display;
    display.space = *space;
    const bool invertible = space->rgb_from_xyz.invertible();
    display.white = invertible ? space->primaries.white : color::RgbSpace::srgb().primaries.white;
    if (invertible) display.icc = icc_of(*space);
    display.srgb = text == "srgb" && !luminance_row;
    if (invertible) display.cicp = code_points_of(*space);
    return display;
}

Status add_proof(const std::string& path, const Rendering& rendering, Display& display) {
    if (display.device || !display.space.rgb_from_xyz.invertible())
        return usage_error("--proof: needs a display with primaries and a known curve, such as --profile srgb");
    const Result<lcms::Profile> profile = lcms::open_profile(path);
    if (!profile) return profile.error().at("--proof");
    const auto proof = proof_of(profile->get(), display.space, rendering);
    if (!proof) return proof.error().at(path);
    const auto gamut = gamut_of(profile->get(), rendering);
    if (!gamut) return gamut.error().at(path);
    display.proof = *proof;
    display.proof_name = lcms::description_of(profile->get());
    display.gamut = *gamut;
    display.proof_space = table_space();
    return {};
}

}  // namespace latent::convert
