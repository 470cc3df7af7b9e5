#include "tools/convert/source.h"

#include <fmt/format.h>

#include "color/rgb_space.h"

namespace latent::convert {

Result<Source> open_source(const ConvertOptions& options) {
    Result<image::ExrReader> reader = image::ExrReader::open(options.input, options.level);
    if (!reader) return reader.error();
    const image::ExrImage& image = reader->image();
    color::Matrix3 xyz_from_file;
    color::Chromaticity white = color::RgbSpace::srgb().primaries.white;  // of XYZ too, unless the file says another
    const color::Primaries primaries =
        image.chromaticities ? color::primaries_of(*image.chromaticities) : color::RgbSpace::srgb().primaries;
    if (!image.xyz && !color::are_xyz(primaries)) {
        const Result<color::RgbSpace> space =
            color::RgbSpace::from_primaries("chromaticities", primaries, color::Transfer::linear());
        if (!space) return space.error().at(options.input.string());
        xyz_from_file = space->xyz_from_rgb;
        white = primaries.white;
    }
    if (const auto& neutral = image.adopted_neutral)
        white = {static_cast<double>((*neutral)[0]), static_cast<double>((*neutral)[1])};

    image::Rect area = image.data_window;
    if (options.crop) {
        if (options.crop->empty() || !area.contains(*options.crop)) {
            return Error{ErrorCode::kUsage, fmt::format("{}: has pixels {},{} to {},{}; --crop {},{},{},{} is not inside",
                                                        options.input.string(), area.x0, area.y0, area.x1, area.y1,
                                                        options.crop->x0, options.crop->y0, options.crop->x1, options.crop->y1)};
        }
        area = *options.crop;
    }
    return Source{std::move(*reader), area, xyz_from_file, white};
}

}  // namespace latent::convert
