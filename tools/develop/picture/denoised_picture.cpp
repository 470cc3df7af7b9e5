#include "tools/develop/picture/denoised_picture.h"

#include <algorithm>
#include <utility>

#include "base/in_order.h"

namespace latent::develop {

namespace {

// Layers that serve the denoiser, and are dropped unless they were asked for.
bool is_dropped(const std::string& name, const Layers& kept) {
    return (!kept.halves && (name.starts_with("half0.") || name.starts_with("half1."))) || (!kept.weight && name == "weight") ||
           (!kept.albedo && name.starts_with("albedo.")) || (!kept.normal && name.starts_with("N.")) ||
           (!kept.depth && name == "Z");
}

}  // namespace

Status DenoisedPicture::begin(const image::ExrTileSpec& spec, std::uint64_t waiting_memory) {
    all_ = {spec.x0, spec.y0, spec.x1, spec.y1};
    values_ = DenoisedValues::find(spec.channels);
    Result<File> file = File::create_unnamed(folder_);
    if (!file) return file.error();
    file_ = std::move(*file);
    image::ExrTileSpec out = spec;
    out.x0 = static_cast<int>(crop_.x0), out.y0 = static_cast<int>(crop_.y0);
    out.x1 = static_cast<int>(crop_.x1), out.y1 = static_cast<int>(crop_.y1);
    out.channels.clear();
    values_.kept.clear();
    for (std::size_t i = 0; i < spec.channels.size(); ++i) {
        if (is_dropped(spec.channels[i], kept_layers_)) continue;
        values_.kept.push_back(i);
        out.channels.push_back(spec.channels[i]);
    }
    return to_.begin(out, waiting_memory);
}

std::uint64_t DenoisedPicture::offset_of(std::int64_t x, std::int64_t y) const {
    const std::int64_t column = x - all_.x0, row = y - all_.y0, tiles = (all_.width() + kTile - 1) / kTile;
    const std::int64_t pixel = ((row / kTile * tiles + column / kTile) * kTile + row % kTile) * kTile + column % kTile;
    return static_cast<std::uint64_t>(pixel) * values_.outputs * sizeof(float);
}

Status DenoisedPicture::write(int x, int y, std::span<const float> pixels) {
    const std::int64_t x0 = all_.x0 + std::int64_t{x} * kTile, y0 = all_.y0 + std::int64_t{y} * kTile;
    const auto row = static_cast<std::size_t>(std::min<std::int64_t>(kTile, all_.x1 - x0)) * values_.outputs;
    if (row == kTile * values_.outputs) return file_->write_all(offset_of(x0, y0), std::as_bytes(pixels));
    for (std::size_t i = 0; i * row < pixels.size(); ++i) {
        const std::uint64_t offset = offset_of(x0, y0 + static_cast<std::int64_t>(i));
        if (Status s = file_->write_all(offset, std::as_bytes(pixels.subspan(i * row, row))); !s) return s;
    }
    return {};
}

Result<std::vector<float>> DenoisedPicture::pixels_in(const PixelRect& pixels) const {
    std::vector<float> values(static_cast<std::size_t>(pixels.width() * pixels.height()) * values_.outputs);
    std::span<float> rest = values;
    for (std::int64_t y = pixels.y0; y < pixels.y1; ++y) {
        for (std::int64_t x = pixels.x0; x < pixels.x1;) {
            const std::int64_t end = std::min(pixels.x1, all_.x0 + ((x - all_.x0) / kTile + 1) * kTile);  // of the tile
            const std::size_t count = static_cast<std::size_t>(end - x) * values_.outputs;
            if (Status s = file_->read_exact(offset_of(x, y), std::as_writable_bytes(rest.first(count))); !s) return s.error();
            rest = rest.subspan(count);
            x = end;
        }
    }
    return values;
}

Status DenoisedPicture::denoise(const Stopped& stopped) {
    const std::int64_t tiles_x = (crop_.width() + kTile - 1) / kTile, tiles_y = (crop_.height() + kTile - 1) / kTile;
    const auto make = [&](std::size_t i) -> Result<std::vector<float>> {
        if (is_true(stopped)) return given_up();
        const std::int64_t x = crop_.x0 + static_cast<std::int64_t>(i) % tiles_x * kTile,
                           y = crop_.y0 + static_cast<std::int64_t>(i) / tiles_x * kTile;
        const PixelRect tile = intersection({x, y, x + kTile, y + kTile}, crop_);
        const PixelRect held = read_by_denoiser(tile, all_);
        const Result<std::vector<float>> noisy = pixels_in(held);
        if (!noisy) return noisy.error();
        return develop::denoise(values_, amount_, held, *noisy, tile);
    };
    const auto take = [&](std::size_t i, std::vector<float> pixels) {
        const auto tile = static_cast<std::int64_t>(i);
        return to_.write(static_cast<int>(tile % tiles_x), static_cast<int>(tile / tiles_x), pixels);
    };
    return make_in_order(static_cast<std::size_t>(tiles_x * tiles_y), make, take);
}

}  // namespace latent::develop
