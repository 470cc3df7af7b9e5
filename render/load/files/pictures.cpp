#include "render/load/files/pictures.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <span>
#include <system_error>

#include "base/file.h"
#include "color/to_srgb.h"
#include "image/exr_reader.h"
#include "image/pictures.h"
#include "image/plausible_size.h"
#include "render/load/files/scene_files.h"

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
    std::error_code failed;
    const std::uintmax_t bytes = std::filesystem::file_size(path, failed);
    if (failed ||
        !image::is_plausible_size(static_cast<std::uint64_t>(window.width()), static_cast<std::uint64_t>(window.height()), bytes)) {
        return Error{ErrorCode::kCorrupt, fmt::format("{}: {} x {} pixels do not fit into a file of its size", path.string(),
                                                      window.width(), window.height())};
    }
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
Result<FilePicture> read_other(const std::filesystem::path& path, const std::string& in_messages) {
    const Result<std::unique_ptr<image::Pictures>> pictures = image::Pictures::create(1 << 20);
    if (!pictures) return pictures.error().at(in_messages);
    const Result<image::WholePicture> picture = (*pictures)->read(path.string(), in_messages, {});
    if (!picture) return picture.error();
    const image::PictureInfo& info = picture->info;
    FilePicture out{info.width, info.height};
    if (info.chromaticities) {
        const Result<color::Matrix3> matrix = color::srgb_from(*info.chromaticities, info.is_white_neutral);
        if (!matrix) return matrix.error().at(in_messages);
        out.srgb_from_file = *matrix;
    }
    for (std::size_t i = 0; i < picture->values.size(); i += info.channels) {
        const float* x = &picture->values[i];
        out.rgb.insert(out.rgb.end(), {x[0], x[info.channels > 1 ? 1 : 0], x[info.channels > 1 ? 2 : 0]});
    }
    return out;
}

}  // namespace

Result<LoadedPicture> read_picture(const std::filesystem::path& path, const std::string& in_messages) {
    const Result<File> there = File::open_read(path);
    if (!there) return there.error();
    std::array<char, 64> front{};
    const Result<std::size_t> read = there->read_some(0, std::as_writable_bytes(std::span(front)));
    if (!read) return read.error();
    if (is_lfs_pointer({front.data(), *read})) return Error{ErrorCode::kForeign, fmt::format("{}: {}", in_messages, kLfsPointer)};
    const Result<FilePicture> picture = path.extension() == ".exr" ? read_exr(path) : read_other(path, in_messages);
    if (!picture) return picture.error();
    LoadedPicture out{.image = {.width = picture->width, .height = picture->height}};
    out.image.rgb.reserve(picture->rgb.size());
    for (std::size_t i = 0; i < picture->rgb.size(); i += 3) {
        const float* rgb = &picture->rgb[i];
        for (const double x : picture->srgb_from_file* std::array<double, 3>{rgb[0], rgb[1], rgb[2]}) {
            const bool good = std::isfinite(x) && x >= 0;
            out.refused += good ? 0 : 1;
            out.image.rgb.push_back(good ? static_cast<float>(x) : 0);
        }
    }
    return out;
}

Result<AlphaUse> alpha_use(const std::filesystem::path& path, const std::string& in_messages) {
    constexpr image::PictureEncoding kAsStored{.is_srgb = false};
    const Result<std::unique_ptr<image::Pictures>> pictures = image::Pictures::create(std::uint64_t{1} << 30);
    if (!pictures) return pictures.error().at(in_messages);
    const Result<image::PictureInfo> info = (*pictures)->open(path.string(), in_messages, kAsStored);
    if (!info) return info.error();
    if (info->is_opaque) return AlphaUse::kUnused;
    const Result<image::WholePicture> whole = (*pictures)->read(path.string(), in_messages, kAsStored);
    if (!whole) return whole.error();
    constexpr double kPlain = 8.0 / 255;  // standard deviation of encoded values
    std::array<double, 3> sum{}, squares{};
    double hidden = 0;
    bool is_seen = false;
    for (std::size_t i = 0; i + 3 < whole->values.size(); i += info->channels) {
        is_seen = is_seen || whole->values[i + 3] > 0;
        if (whole->values[i + 3] > 0) continue;
        ++hidden;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto value = static_cast<double>(whole->values[i + c]);
            sum[c] += value, squares[c] += value * value;
        }
    }
    if (!is_seen) return AlphaUse::kUnused;
    for (std::size_t c = 0; c < 3 && hidden > 0; ++c) {
        const double mean = sum[c] / hidden;
        if (squares[c] / hidden - mean * mean > kPlain * kPlain) return AlphaUse::kOther;
    }
    return AlphaUse::kOpacity;
}

bool is_opaque(const std::filesystem::path& path) {
    const Result<std::unique_ptr<image::Pictures>> pictures = image::Pictures::create(1 << 20);
    if (!pictures) return false;
    const Result<image::PictureInfo> info = (*pictures)->open(path.string(), path.string(), {});
    return info && info->is_opaque;
}

NormalUse normal_use(const std::filesystem::path& path, const std::string& in_messages) {
    constexpr double kNear = 0.15;
    const auto is_near = [&](bool is_srgb) {
        const Result<std::unique_ptr<image::Pictures>> pictures = image::Pictures::create(1 << 20);
        if (!pictures) return false;
        const Result<image::WholePicture> whole = (*pictures)->read(path.string(), in_messages, {.is_srgb = is_srgb});
        if (!whole || whole->info.channels < 3) return false;
        std::array<double, 3> sum{};
        for (std::size_t i = 0; i < whole->values.size(); i += whole->info.channels) {
            for (std::size_t c = 0; c < 3; ++c) sum[c] += static_cast<double>(whole->values[i + c]);
        }
        const double pixels = static_cast<double>(whole->info.width) * whole->info.height;
        return std::abs(sum[0] / pixels - 0.5) < kNear && std::abs(sum[1] / pixels - 0.5) < kNear &&
               sum[2] / pixels > 1 - 2 * kNear;
    };
    return is_near(false) ? NormalUse::kAsStored : is_near(true) ? NormalUse::kAsSrgb : NormalUse::kNothing;
}

double mean_luminance(const ImageDescription& image, const std::array<double, 3>& factor) {
    const auto& row = color::RgbSpace::srgb().luminance_row;
    double sum = 0;
    for (std::size_t i = 0; i < image.rgb.size(); ++i) sum += row[i % 3] * factor[i % 3] * static_cast<double>(image.rgb[i]);
    return image.rgb.empty() ? 0 : sum / (static_cast<double>(image.rgb.size()) / 3);
}

}  // namespace latent::render
