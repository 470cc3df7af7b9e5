// tools/convert/spread_light.h: a picture whose light spreads by a kernel, made tile by tile while it is printed. Rows wait in
// files without a name, so that memory holds one tile of a picture of any size.
#pragma once

#include <filesystem>
#include <memory>

#include "base/file.h"
#include "image/convolver.h"
#include "image/exr_reader.h"
#include "tools/convert/bands.h"
#include "tools/convert/source.h"

namespace latent::convert {

// The last rows of a picture, in a file.
class RowFile {
 public:
    // Of the columns of `window`; keeps `rows` of them. Errors: kIo.
    static Result<RowFile> create(const std::filesystem::path& folder, const image::Rect& window, int rows);
    Status write(std::size_t channel, int x0, int y, std::span<const float> row);
    Status read(std::size_t channel, int x0, int y, std::span<float> row) const;

 private:
    RowFile(File file, const image::Rect& window, int rows) : file_(std::move(file)), window_(window), rows_(rows) {}
    std::uint64_t place(std::size_t channel, int x, int y) const;
    File file_;
    image::Rect window_;
    int rows_;
};

class SpreadLight {
 public:
    // Of the pixels of `source`, which outlives it; `print`: the bands that will be prepared. The files are in `folder`.
    // Errors: kIo.
    static Result<std::unique_ptr<SpreadLight>> make(const Source& source, image::Kernel kernel, const BandPlan& print,
                                                     const std::filesystem::path& folder, int threads);

    // What it holds, of a kernel of this radius.
    static std::size_t bytes(const image::ExrImage& image, int radius, int threads);

    // Makes the rows of a band; bands come in their order. On any threads. Errors: of reading; kIo.
    Status prepare(const image::Rect& band);
    // Of the band that was prepared. From any thread.
    Status read(const image::Rect& area, const std::array<float*, 3>& planes, std::size_t row_stride) const;

 private:
    SpreadLight(const Source& source, image::Convolver convolver, const image::Rect& wanted, BandPlan input, RowFile before,
                RowFile after);
    Status load(int y1);
    Status make_tiles(int y0);

    const Source& source_;
    image::Convolver convolver_;
    image::Rect wanted_;
    BandPlan input_;
    RowFile before_, after_;
    std::size_t next_band_ = 0;  // of input_
    int loaded_, made_;          // rows up to here
    image::Convolver::Planes planes_;
};

}  // namespace latent::convert
