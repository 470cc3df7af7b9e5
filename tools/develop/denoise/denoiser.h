// tools/develop/denoise/denoiser.h: a pixel becomes a mean over the pixels around it whose samples could be of the same light.
// docs/developing.md, "Denoising".
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/develop/film/film_grid.h"

namespace latent::develop {

// Where things stand among the values of a pixel: the first of each.
struct DenoisedValues {
    // Values that noise is removed from, and what either half says of them.
    struct Part {
        std::size_t value, half0, half1;
    };
    std::size_t outputs = 0, channels = 0;
    Part picture{};
    std::vector<Part> lights{};                              // whose sum is the picture; none: it is denoised itself
    std::optional<std::size_t> albedo{}, normal{}, depth{};  // three, three and one
    std::optional<std::size_t> weight{};                     // sum w c: a pixel without camera records is no neighbour
    std::optional<std::size_t> variance{};                   // becomes that of the denoised picture
    std::vector<std::size_t> kept{};                         // all that are wanted of a denoised pixel

    // From the names that RowLayout gives; those of the channels come first. All are kept.
    static DenoisedValues find(const std::vector<std::string>& names);
};

// Pixels around one that it may depend on, in each direction; those of `picture` that are so near to `pixels`: they depend on
// these, and these on them.
inline constexpr std::int64_t kDenoiseReach = 8;
PixelRect within_reach(const PixelRect& pixels, const PixelRect& picture);

// `pixels` are those of `held`, row after row, all values of a pixel together. Returns those of `wanted`, in the same way, but of
// their values only `kept`. `held` must hold all that `wanted` depends on. `amount`: of the denoised picture (0..1]; the rest is
// the noisy one.
std::vector<float> denoise(const DenoisedValues& values, double amount, const PixelRect& held, std::span<const float> pixels,
                           const PixelRect& wanted);

}  // namespace latent::develop
