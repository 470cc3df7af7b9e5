#include "render/load/pbrt/environment_image.h"

#include <fmt/format.h>

#include <array>

#include "base/file.h"
#include "color/to_srgb.h"
#include "image/exr_reader.h"
#include "image/pictures.h"

namespace latent::render {

namespace {

// A picture as its file has it: linear, three values a pixel, and the way to sRGB.
struct FilePicture {
    std::uint32_t width = 0, height = 0;
    std::vector<float> rgb{};
    color::Matrix3 srgb_from_file{};
};

// XYZ comes as X, Y, Z, or as R, G, B with primaries that are the axes of XYZ.
Result<FilePicture> read_exr(const std::filesystem::path& path) {
    const Result<image::ExrReader> reader = image::ExrReader::open(path);
    if (!reader) return reader.error();
    const image::ExrImage& header = reader->image();
    FilePicture out;
    if (header.xyz) {
        out.srgb_from_file = color::RgbSpace::srgb().rgb_from_xyz;
    } else if (header.chromaticities) {
        const Result<color::Matrix3> matrix = color::srgb_from(*header.chromaticities);
        if (!matrix) return matrix.error().at(path.string());
        out.srgb_from_file = *matrix;
    }
    const image::Rect window = header.data_window;
    if (window.empty()) return out;
    out.width = static_cast<std::uint32_t>(window.width());
    out.height = static_cast<std::uint32_t>(window.height());
    const std::size_t pixels = window.pixels();
    std::array<std::vector<float>, 3> planes{std::vector<float>(pixels), std::vector<float>(pixels), std::vector<float>(pixels)};
    image::ExrReader::Scratch scratch;
    if (const Status read = reader->read(window, {planes[0].data(), planes[1].data(), planes[2].data()},
                                         static_cast<std::size_t>(window.width()), scratch);
        !read)
        return read.error();
    out.rgb.reserve(3 * pixels);
    for (std::size_t i = 0; i < pixels; ++i) out.rgb.insert(out.rgb.end(), {planes[0][i], planes[1][i], planes[2][i]});
    return out;
}

// Integers are encoded as sRGB.
Result<FilePicture> read_other(const std::filesystem::path& path) {
    const Result<std::unique_ptr<image::Pictures>> pictures = image::Pictures::create(1 << 20);
    if (!pictures) return pictures.error();
    const Result<image::WholePicture> picture = (*pictures)->read(path.string(), {});
    if (!picture) return picture.error();
    const image::PictureInfo& info = picture->info;
    FilePicture out{info.width, info.height};
    if (info.chromaticities) {
        const Result<color::Matrix3> matrix = color::srgb_from(*info.chromaticities);
        if (!matrix) return matrix.error().at(path.string());
        out.srgb_from_file = *matrix;
    }
    for (std::size_t i = 0; i < picture->values.size(); i += info.channels) {
        const float* x = &picture->values[i];
        out.rgb.insert(out.rgb.end(), {x[0], x[info.channels > 1 ? 1 : 0], x[info.channels > 1 ? 2 : 0]});
    }
    return out;
}

}  // namespace

std::shared_ptr<const ImageDescription> read_environment(const ParameterList& list, const std::string& name, SceneFiles& files) {
    const std::filesystem::path path = files.resolve(name);
    if (const Result<File> there = File::open_read(path); !there) {
        list.error(there.error().message);
        return nullptr;
    }
    const Result<FilePicture> picture = path.extension() == ".exr" ? read_exr(path) : read_other(path);
    if (!picture) {
        list.error(picture.error().message);
        return nullptr;
    }
    if (picture->width == 0 || picture->width != picture->height) {
        list.error(
            fmt::format("{}: {} x {} is not square, as the equal-area mapping requires; convert it with imgtool makeequiarea", name,
                        picture->width, picture->height));
        return nullptr;
    }
    auto out = std::make_shared<ImageDescription>();
    out->width = picture->width;
    out->height = picture->height;
    out->rgb.reserve(picture->rgb.size());
    std::size_t refused = 0;
    for (std::size_t i = 0; i < picture->rgb.size(); i += 3) {
        const float* rgb = &picture->rgb[i];
        for (const double x : picture->srgb_from_file* std::array<double, 3>{rgb[0], rgb[1], rgb[2]}) {
            const bool good = std::isfinite(x) && x >= 0;
            refused += good ? 0 : 1;
            out->rgb.push_back(good ? static_cast<float>(x) : 0);
        }
    }
    if (refused > 0) list.warn(fmt::format("{}: {} negative or non-finite values count as 0", name, refused));
    return out;
}

}  // namespace latent::render
