#include "tools/convert/display.h"

#include <charconv>
#include <filesystem>

namespace latent::convert {

namespace {

// 9 numbers with commas between them.
std::optional<color::Matrix3> matrix_of(const std::string& text) {
    color::Matrix3 matrix;
    const char *at = text.data(), *end = at + text.size();
    for (std::size_t i = 0; i < 9; ++i) {
        const auto [next, error] = std::from_chars(at, end, matrix.m[i / 3][i % 3]);
        if (error != std::errc{} || (i < 8 ? next == end || *next != ',' : next != end)) return std::nullopt;
        at = next + 1;
    }
    return matrix;
}

}  // namespace

Result<Display> display_from(const std::string& text, const std::optional<std::array<double, 3>>& luminance_row) {
    const std::string extension = std::filesystem::path(text).extension().string();
    if (extension == ".icc" || extension == ".icm" || extension == ".ICC" || extension == ".ICM")
        return display_from_icc(text, luminance_row);
    const std::array<double, 3>* m = luminance_row ? &*luminance_row : nullptr;
    const std::optional<color::Matrix3> matrix = matrix_of(text);
    Result<color::RgbSpace> space =
        matrix ? color::RgbSpace::from_matrix(text, *matrix, m, color::Transfer::srgb()) : color::RgbSpace::parse(text);
    if (space && m != nullptr && !matrix)
        space = color::RgbSpace::from_matrix(space->name, space->rgb_from_xyz, m, space->transfer);
    if (!space) return Error{ErrorCode::kUsage, space.error().message}.at("--profile");  // impossible numbers are wrong usage too
    Display display;
    display.space = *space;
    const bool invertible = space->rgb_from_xyz.invertible();
    display.white = invertible ? space->primaries.white : color::RgbSpace::srgb().primaries.white;
    if (invertible) display.icc = icc_of(*space);
    display.srgb = text == "srgb" && !luminance_row;
    if (text == "display-p3") display.cicp = {12, 13, 0, 1};
    return display;
}

}  // namespace latent::convert
