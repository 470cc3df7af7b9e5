// tools/develop/picture/denoised_picture.h: a picture that is denoised once all of its pixels are known.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "base/file.h"
#include "base/progress.h"
#include "tools/develop/channels/layers.h"
#include "tools/develop/denoise/denoiser.h"
#include "tools/develop/picture/picture_sink.h"

namespace latent::develop {

class DenoisedPicture final : public PictureSink {
 public:
    // What it takes has halves, and as many pixels more around `crop` as the whole picture has within kDenoiseReach. What it passes
    // on to `to`: the pixels of `crop`, and of the layers only `kept`. Pixels wait in an unnamed file in `folder`.
    DenoisedPicture(PictureSink& to, double amount, const PixelRect& crop, const Layers& kept, std::filesystem::path folder)
        : to_(to), amount_(amount), crop_(crop), kept_layers_(kept), folder_(std::move(folder)) {}

    Status begin(const image::ExrTileSpec& spec, std::uint64_t waiting_memory) override;
    Status write(int x, int y, std::span<const float> pixels) override;
    // After the last tile: passes all on, made by the threads of the caller's arena. Errors: those of `to`, kStopped.
    Status denoise(const Stopped& stopped);
    Status finish() override { return to_.finish(); }
    std::uint64_t bytes_on_disk() const { return offset_of(all_.x0, all_.y1 + kTile - 1); }

 private:
    std::uint64_t offset_of(std::int64_t x, std::int64_t y) const;  // of a pixel's values in the file
    Result<std::vector<float>> pixels_in(const PixelRect& pixels) const;

    PictureSink& to_;
    double amount_;
    PixelRect crop_;
    Layers kept_layers_;
    std::filesystem::path folder_;

    PixelRect all_;  // that are taken
    DenoisedValues values_;
    std::optional<File> file_;  // tiles, each with room for kTile rows of kTile pixels
};

}  // namespace latent::develop
