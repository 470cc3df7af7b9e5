// tools/develop/picture/denoised_picture.h: a picture whose tiles are denoised when all pixels around them are known.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "base/file.h"
#include "tools/develop/channels/layers.h"
#include "tools/develop/denoise/denoiser.h"
#include "tools/develop/picture/picture_sink.h"

namespace latent::develop {

class DenoisedPicture final : public PictureSink {
 public:
    // What it takes has halves, and as many pixels more around `crop` as the whole picture has within kDenoiseReach. What it passes
    // on to `to`: the pixels of `crop`, and of the layers only `kept`. Noisy tiles wait in an unnamed file in `folder`.
    DenoisedPicture(PictureSink& to, double amount, const PixelRect& crop, const Layers& kept, std::filesystem::path folder)
        : to_(to), amount_(amount), kept_layers_(kept), folder_(std::move(folder)), denoised_(crop) {}

    Status begin(const image::ExrTileSpec& spec, std::uint64_t waiting_memory) override;
    Status write(int x, int y, std::span<const float> pixels) override;
    Status after_pane() override;
    Status finish() override { return to_.finish(); }
    std::uint64_t bytes_on_disk() const { return slot_count_ * slot_bytes(); }

 private:
    // A rectangle of pixels as tiles, which are counted row by row.
    class Tiles {
     public:
        explicit Tiles(const PixelRect& pixels) : pixels_(pixels) {}
        const PixelRect& pixels() const { return pixels_; }
        std::size_t count() const { return columns() * tiles_in(pixels_.height()); }
        std::size_t number(int x, int y) const { return static_cast<std::size_t>(y) * columns() + static_cast<std::size_t>(x); }
        int column(std::size_t tile) const { return static_cast<int>(tile % columns()); }
        int row(std::size_t tile) const { return static_cast<int>(tile / columns()); }
        PixelRect tile(std::size_t i) const {
            const std::int64_t x = pixels_.x0 + std::int64_t{column(i)} * kTile, y = pixels_.y0 + std::int64_t{row(i)} * kTile;
            return intersection({x, y, x + kTile, y + kTile}, pixels_);
        }
        // Visits those that have pixels of `part`, which lies in all of them.
        template <class Visit>
        void for_those_in(const PixelRect& part, const Visit& visit) const {
            for (std::int64_t y = (part.y0 - pixels_.y0) / kTile; y * kTile < part.y1 - pixels_.y0; ++y) {
                for (std::int64_t x = (part.x0 - pixels_.x0) / kTile; x * kTile < part.x1 - pixels_.x0; ++x)
                    visit(number(static_cast<int>(x), static_cast<int>(y)));
            }
        }

     private:
        static std::size_t tiles_in(std::int64_t length) { return static_cast<std::size_t>((length + kTile - 1) / kTile); }
        std::size_t columns() const { return tiles_in(pixels_.width()); }
        PixelRect pixels_;
    };
    // Where a noisy tile waits, until so many denoised ones have read it.
    struct Slot {
        std::uint64_t number = 0;
        int readers = 0;
    };

    std::uint64_t slot_bytes() const { return std::uint64_t{kTile} * kTile * values_.outputs * sizeof(float); }
    PixelRect read_by(std::size_t tile) const;  // pixels that a denoised tile depends on
    Result<std::vector<float>> pixels_in(const PixelRect& pixels) const;

    PictureSink& to_;
    double amount_;
    Layers kept_layers_;
    std::filesystem::path folder_;
    Tiles denoised_;

    Tiles noisy_{{}};
    DenoisedValues values_;
    std::optional<File> file_;
    std::vector<Slot> slots_;  // those of noisy tiles
    std::vector<std::uint64_t> free_slots_;
    std::uint64_t slot_count_ = 0;
    std::vector<int> missing_;        // noisy tiles that each denoised one waits for
    std::vector<std::size_t> ready_;  // denoised tiles that wait for none
};

}  // namespace latent::develop
