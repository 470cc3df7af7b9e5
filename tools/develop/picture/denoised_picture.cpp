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
    noisy_ = Tiles({spec.x0, spec.y0, spec.x1, spec.y1});
    values_ = DenoisedValues::find(spec.channels);
    Result<File> file = File::create_unnamed(folder_);
    if (!file) return file.error();
    file_ = std::move(*file);
    slots_.assign(noisy_.count(), {});
    free_slots_.clear();
    slot_count_ = 0;
    missing_.assign(denoised_.count(), 0);
    for (std::size_t i = 0; i < missing_.size(); ++i)
        noisy_.for_those_in(read_by(i), [&](std::size_t tile) { ++missing_[i], ++slots_[tile].readers; });
    ready_.clear();
    image::ExrTileSpec out = spec;
    const PixelRect& crop = denoised_.pixels();
    out.x0 = static_cast<int>(crop.x0), out.y0 = static_cast<int>(crop.y0);
    out.x1 = static_cast<int>(crop.x1), out.y1 = static_cast<int>(crop.y1);
    out.channels.clear();
    values_.kept.clear();
    for (std::size_t i = 0; i < spec.channels.size(); ++i) {
        if (is_dropped(spec.channels[i], kept_layers_)) continue;
        values_.kept.push_back(i);
        out.channels.push_back(spec.channels[i]);
    }
    return to_.begin(out, waiting_memory);
}

PixelRect DenoisedPicture::read_by(std::size_t tile) const { return within_reach(denoised_.tile(tile), noisy_.pixels()); }

Status DenoisedPicture::write(int x, int y, std::span<const float> pixels) {
    const std::size_t i = noisy_.number(x, y);
    Slot& slot = slots_[i];
    if (free_slots_.empty()) {
        slot.number = slot_count_++;
    } else {
        slot.number = free_slots_.back();
        free_slots_.pop_back();
    }
    denoised_.for_those_in(within_reach(noisy_.tile(i), denoised_.pixels()), [&](std::size_t tile) {
        if (--missing_[tile] == 0) ready_.push_back(tile);
    });
    return file_->write_all(slot.number * slot_bytes(), std::as_bytes(pixels));
}

Result<std::vector<float>> DenoisedPicture::pixels_in(const PixelRect& pixels) const {
    std::vector<float> values(static_cast<std::size_t>(pixels.width() * pixels.height()) * values_.outputs);
    Status status;
    noisy_.for_those_in(pixels, [&](std::size_t i) {
        const PixelRect tile = noisy_.tile(i), part = intersection(tile, pixels);
        const auto place = [this](const PixelRect& in, std::int64_t x, std::int64_t y) {
            return static_cast<std::size_t>((y - in.y0) * in.width() + x - in.x0) * values_.outputs;
        };
        for (std::int64_t y = part.y0; y < part.y1 && status; ++y) {
            const std::span<float> row =
                std::span(values).subspan(place(pixels, part.x0, y), static_cast<std::size_t>(part.width()) * values_.outputs);
            const std::uint64_t offset = slots_[i].number * slot_bytes() + place(tile, part.x0, y) * sizeof(float);
            status = file_->read_exact(offset, std::as_writable_bytes(row));
        }
    });
    if (!status) return status.error();
    return values;
}

Status DenoisedPicture::after_pane() {
    const auto make = [&](std::size_t i) -> Result<std::vector<float>> {
        const PixelRect held = read_by(ready_[i]);
        const Result<std::vector<float>> noisy = pixels_in(held);
        if (!noisy) return noisy.error();
        return denoise(values_, amount_, held, *noisy, denoised_.tile(ready_[i]));
    };
    const auto take = [&](std::size_t i, std::vector<float> pixels) {
        noisy_.for_those_in(read_by(ready_[i]), [&](std::size_t tile) {
            if (--slots_[tile].readers == 0) free_slots_.push_back(slots_[tile].number);
        });
        return to_.write(denoised_.column(ready_[i]), denoised_.row(ready_[i]), pixels);
    };
    const Status status = make_in_order(ready_.size(), make, take);
    ready_.clear();
    return status;
}

}  // namespace latent::develop
