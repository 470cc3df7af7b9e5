#include "render/load/files/lat_long.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/math/equal_area.h"

namespace latent::render {

bool is_lat_long(const ImageDescription& image) { return image.height > 0 && image.width == 2 * std::uint64_t{image.height}; }

ImageDescription equal_area_from_lat_long(const ImageDescription& image) {
    constexpr std::uint32_t kPlaces = 4;  // in each direction of a pixel
    // A pixel is no larger than one of the picture at the equator: 4 pi / side^2 <= pi^2 / height^2.
    const auto side = static_cast<std::uint32_t>(std::ceil(image.height * 2 / std::sqrt(std::numbers::pi)));
    ImageDescription out{side, side, std::vector<float>(std::size_t{3} * side * side)};
    const auto index = [](double x, std::uint32_t size) { return std::min(static_cast<std::uint32_t>(x * size), size - 1); };
    const auto pixel_at = [&](std::uint32_t x, std::uint32_t y) {  // in the picture
        const Vec3f d = sphere_from_square({(static_cast<float>(x) + 0.5f) / static_cast<float>(side * kPlaces),
                                            (static_cast<float>(y) + 0.5f) / static_cast<float>(side * kPlaces)});
        const double phi = std::atan2(static_cast<double>(d.y), static_cast<double>(d.x)) / (2 * std::numbers::pi);
        const double theta = std::acos(std::clamp(static_cast<double>(d.z), -1.0, 1.0)) / std::numbers::pi;
        return &image
                    .rgb[3 * (std::size_t{index(theta, image.height)} * image.width + index(phi < 0 ? phi + 1 : phi, image.width))];
    };
    tbb::parallel_for(0u, side, [&](std::uint32_t y) {
        for (std::uint32_t x = 0; x < side; ++x) {
            std::array<double, 3> sum{};
            for (std::uint32_t i = 0; i < kPlaces * kPlaces; ++i) {
                const float* rgb = pixel_at(x * kPlaces + i % kPlaces, y * kPlaces + i / kPlaces);
                for (std::size_t c = 0; c < 3; ++c) sum[c] += static_cast<double>(rgb[c]);
            }
            for (std::size_t c = 0; c < 3; ++c)
                out.rgb[3 * (std::size_t{y} * side + x) + c] = static_cast<float>(sum[c] / (kPlaces * kPlaces));
        }
    });
    return out;
}

}  // namespace latent::render
