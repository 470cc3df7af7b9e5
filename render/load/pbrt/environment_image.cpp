#include "render/load/pbrt/environment_image.h"

#include <fmt/format.h>

#include <array>

#include "color/rgb_space.h"
#include "image/exr_reader.h"

namespace latent::render {

namespace {

// Linear sRGB from what the file's channels are. XYZ comes as X, Y, Z, or as R, G, B with primaries that are the axes of XYZ.
Result<color::Matrix3> srgb_from(const image::ExrImage& image) {
    const color::RgbSpace& srgb = color::RgbSpace::srgb();
    if (image.xyz) return srgb.rgb_from_xyz;
    if (!image.chromaticities) return color::Matrix3{};
    const color::Primaries primaries = color::primaries_of(*image.chromaticities);
    if (color::are_xyz(primaries)) return srgb.rgb_from_xyz;
    const Result<color::RgbSpace> space = color::RgbSpace::from_primaries("file", primaries, srgb.transfer);
    if (!space) return space.error();
    return srgb.rgb_from_xyz * space->xyz_from_rgb;
}

}  // namespace

std::shared_ptr<const ImageDescription> read_environment(const ParameterList& list, const std::string& name, SceneFiles& files) {
    const Result<image::ExrReader> reader = image::ExrReader::open(files.resolve(name));
    if (!reader) {
        list.error(reader.error().message + "; environment images must be EXR files");
        return nullptr;
    }
    const image::Rect window = reader->image().data_window;
    if (window.empty() || window.width() != window.height()) {
        list.error(
            fmt::format("{}: {} x {} is not square, as the equal-area mapping requires; convert it with imgtool makeequiarea", name,
                        window.width(), window.height()));
        return nullptr;
    }
    const std::size_t pixels = window.pixels();
    std::array<std::vector<float>, 3> planes{std::vector<float>(pixels), std::vector<float>(pixels), std::vector<float>(pixels)};
    image::ExrReader::Scratch scratch;
    const Status read = reader->read(window, {planes[0].data(), planes[1].data(), planes[2].data()},
                                     static_cast<std::size_t>(window.width()), scratch);
    if (!read) {
        list.error(read.error().message);
        return nullptr;
    }
    auto out = std::make_shared<ImageDescription>();
    out->width = static_cast<std::uint32_t>(window.width());
    out->height = static_cast<std::uint32_t>(window.height());
    out->rgb.reserve(pixels * 3);
    const Result<color::Matrix3> matrix = srgb_from(reader->image());
    if (!matrix) {
        list.error(fmt::format("{}: {}", name, matrix.error().message));
        return nullptr;
    }
    std::size_t refused = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        for (const double x : *matrix* std::array<double, 3>{planes[0][i], planes[1][i], planes[2][i]}) {
            const bool good = std::isfinite(x) && x >= 0;
            refused += good ? 0 : 1;
            out->rgb.push_back(good ? static_cast<float>(x) : 0);
        }
    }
    if (refused > 0) list.warn(fmt::format("{}: {} negative or non-finite values count as 0", name, refused));
    return out;
}

}  // namespace latent::render
