#include "tools/develop/picture/oidn_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <string>

#include "color/rgb_space.h"

namespace latent::develop {

static_assert(std::endian::native == std::endian::little, "a PFM file with the scale -1 is little-endian");

Status OidnPicture::begin(const image::ExrTileSpec& spec, std::uint64_t) {
    if (spec.chromaticities != color::chromaticities_of(color::kXyzPrimaries))
        return usage_error("--for-oidn: needs a picture in XYZ, which becomes linear sRGB; this one has other channels");
    width_ = spec.x1 - spec.x0, height_ = spec.y1 - spec.y0;
    outputs_ = spec.channels.size();
    parts_.clear();
    const std::string header = fmt::format("PF\n{} {}\n-1.0\n", width_, height_);
    const auto add = [&](const char* channel, const std::filesystem::path& path) -> Status {
        const auto at = std::ranges::find(spec.channels, channel);
        if (at == spec.channels.end()) return {};
        Result<OutputFile> file = OutputFile::create(path, replace_);
        if (!file) return file.error();
        parts_.push_back({*std::move(file), static_cast<std::size_t>(at - spec.channels.begin()), header.size()});
        return parts_.back().file.file().write_all(0, std::as_bytes(std::span(header)));
    };
    if (Status s = add("albedo.R", prefix_.string() + ".alb.pfm"); !s) return s;
    if (Status s = add("N.X", prefix_.string() + ".nrm.pfm"); !s) return s;
    return add("R", colour_of(prefix_));
}

Status OidnPicture::write(int x, int y, std::span<const float> pixels) {
    const std::int64_t x0 = std::int64_t{x} * kTile, y0 = std::int64_t{y} * kTile;
    const auto columns = static_cast<std::size_t>(std::min<std::int64_t>(kTile, width_ - x0));
    const std::size_t rows = pixels.size() / (columns * outputs_);
    std::vector<std::array<float, 3>> row(columns);
    for (Part& part : parts_) {
        for (std::size_t i = 0; i < rows; ++i) {
            for (std::size_t column = 0; column < columns; ++column)
                std::copy_n(pixels.data() + (i * columns + column) * outputs_ + part.first, 3, row[column].data());
            if (&part == &parts_.back()) {
                for (std::array<float, 3>& pixel : row) {
                    const std::array<double, 3> rgb =
                        color::RgbSpace::srgb().rgb_from_xyz * std::array<double, 3>{pixel[0], pixel[1], pixel[2]};
                    std::ranges::transform(rgb, pixel.begin(), [](double value) { return static_cast<float>(value); });
                }
            }
            const std::int64_t line = height_ - 1 - y0 - static_cast<std::int64_t>(i);  // from the bottom up
            const std::uint64_t offset = part.header + static_cast<std::uint64_t>(line * width_ + x0) * sizeof row[0];
            if (Status s = part.file.file().write_all(offset, std::as_bytes(std::span(row))); !s) return s;
        }
    }
    return {};
}

Status OidnPicture::finish() {
    for (Part& part : parts_) {
        if (Status s = part.file.publish(); !s) return s;
    }
    return {};
}

}  // namespace latent::develop
