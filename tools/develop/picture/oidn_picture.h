// tools/develop/picture/oidn_picture.h: a picture as the PFM files that Open Image Denoise takes. docs/developing.md, "Layers".
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "base/file.h"
#include "tools/develop/picture/picture_sink.h"

namespace latent::develop {

// PREFIX.hdr.pfm: linear sRGB; and PREFIX.alb.pfm and PREFIX.nrm.pfm, if the picture has the layers albedo and normal.
class OidnPicture final : public PictureSink {
 public:
    static std::filesystem::path colour_of(const std::filesystem::path& prefix) { return prefix.string() + ".hdr.pfm"; }

    // `replace`: existing files.
    OidnPicture(std::filesystem::path prefix, bool replace) : prefix_(std::move(prefix)), replace_(replace) {}

    // Errors of all three: kExists, kIo, kNoSpace; of `begin`, kUsage unless the picture is in XYZ.
    Status begin(const image::ExrTileSpec& spec, std::uint64_t waiting_memory) override;
    Status write(int x, int y, std::span<const float> pixels) override;
    Status finish() override;

 private:
    struct Part {
        OutputFile file;
        std::size_t first, header;  // place of its three values among those of a pixel; bytes before its pixels
    };

    const std::filesystem::path prefix_;
    const bool replace_;
    std::int64_t width_ = 0, height_ = 0;
    std::size_t outputs_ = 0;  // values of a pixel that is written
    std::vector<Part> parts_;  // the colours last
};

}  // namespace latent::develop
