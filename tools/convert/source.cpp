#include "tools/convert/source.h"

#include <fmt/format.h>

#include "color/rgb_space.h"

namespace latent::convert {

namespace {

constexpr std::array<float, 8> kXyzPrimaries{1, 0, 0, 1, 0, 0, 1 / 3.0f, 1 / 3.0f};

color::Chromaticity xy(float x, float y) { return {static_cast<double>(x), static_cast<double>(y)}; }

bool is_xyz(const image::ExrImage& image) {
    if (image.xyz || !image.chromaticities) return image.xyz;
    bool same = true;
    for (std::size_t i = 0; i < 8; ++i) same = same && std::abs((*image.chromaticities)[i] - kXyzPrimaries[i]) < 1e-4f;
    return same;
}

}  // namespace

Result<Source> open_source(const ConvertOptions& options) {
    Result<image::ExrReader> reader = image::ExrReader::open(options.input, options.level);
    if (!reader) return reader.error();
    const image::ExrImage& image = reader->image();
    color::Matrix3 xyz_from_file;
    color::Primaries primaries = color::RgbSpace::srgb().primaries;
    if (!is_xyz(image)) {
        if (image.chromaticities) {
            const std::array<float, 8>& c = *image.chromaticities;
            primaries = {xy(c[0], c[1]), xy(c[2], c[3]), xy(c[4], c[5]), xy(c[6], c[7])};
        }
        const Result<color::RgbSpace> space =
            color::RgbSpace::from_primaries("chromaticities", primaries, color::Transfer::linear());
        if (!space) return space.error().at(options.input.string());
        xyz_from_file = space->xyz_from_rgb;
    }
    color::Chromaticity white = primaries.white;
    if (image.adopted_neutral) white = xy((*image.adopted_neutral)[0], (*image.adopted_neutral)[1]);

    image::Rect area = image.data_window;
    if (options.crop) {
        if (options.crop->empty() || !area.contains(*options.crop)) {
            return Error{ErrorCode::kOutOfRange,
                         fmt::format("{}: holds the pixels {},{} to {},{}; --crop {},{},{},{} is not inside them",
                                     options.input.string(), area.x0, area.y0, area.x1, area.y1, options.crop->x0, options.crop->y0,
                                     options.crop->x1, options.crop->y1)};
        }
        area = *options.crop;
    }
    return Source{std::move(*reader), area, xyz_from_file, white};
}

}  // namespace latent::convert
