#include "color/adaptation.h"

#include <fmt/format.h>

namespace latent::color {
namespace {

constexpr Matrix3 kBradfordCones{{{{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}}};
constexpr Matrix3 kCat16Cones{
    {{{0.401288, 0.650173, -0.051461}, {-0.250268, 1.204414, 0.045854}, {-0.002079, 0.048952, 0.953127}}}};

}  // namespace

Result<Cones> cones_by_name(std::string_view name) {
    if (name == "bradford") return Cones::kBradford;
    if (name == "cat16") return Cones::kCat16;
    return usage_error(fmt::format("unknown adaptation \"{}\"; choose bradford or cat16", name));
}

Result<Matrix3> adaptation_matrix(Chromaticity from, Chromaticity to, Cones cones) {
    if (from == to) return Matrix3{};
    const Matrix3& response = cones == Cones::kCat16 ? kCat16Cones : kBradfordCones;
    Matrix3 scale;
    for (const Chromaticity white : {from, to}) {
        if (!(white.x > 0 && white.y > 0 && white.x + white.y < 1)) {
            return Error{ErrorCode::kOutOfRange, fmt::format("({}, {}) is not the chromaticity of a white", white.x, white.y)};
        }
    }
    const auto cone_response = [&](Chromaticity white) {
        const Xyz xyz = xyz_from_chromaticity(white);
        return response * std::array{xyz.x, xyz.y, xyz.z};
    };
    const auto source = cone_response(from), target = cone_response(to);
    for (int i = 0; i < 3; ++i) {
        if (!(source[i] > 0 && target[i] > 0)) {
            return Error{
                ErrorCode::kOutOfRange,
                fmt::format("({}, {}) cannot be adapted to ({}, {}): a cone response is not positive", from.x, from.y, to.x, to.y)};
        }
        scale.m[i][i] = target[i] / source[i];
    }
    return response.inverse() * scale * response;
}

}  // namespace latent::color
