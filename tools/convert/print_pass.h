// tools/convert/print_pass.h: the picture passes by in bands, is printed, and goes to all outputs. docs/converting.md, "How pixels
// pass through".
#pragma once

#include <memory>
#include <vector>

#include "base/progress.h"
#include "tools/convert/bands.h"
#include "tools/convert/options.h"
#include "tools/convert/rows.h"
#include "tools/convert/sink.h"
#include "tools/convert/source.h"

namespace latent::convert {

// One print of the picture, and the outputs that get it.
struct Exposure {
    double stops = 0, sigma = 1;
    color::Print print;
    std::shared_ptr<const film::Process>
        film{};  // develops and prints what the picture holds times `sigma`, before `print`; or null
    std::vector<std::filesystem::path> paths;
    std::vector<std::unique_ptr<Sink>> sinks;
};

struct PassSettings {
    std::array<double, 3> y_row;                   // luminance in the scene, of the file's pixels
    color::RgbSpace space;                         // that is printed for
    std::shared_ptr<const DeviceTransform> proof;  // applied to what was printed; null: none
    color::RgbSpace shown_space;                   // the result's
    std::shared_ptr<const DeviceGamut> gamut;      // null: that of `space`
    bool show_clipped = false, gamut_report = false;
    std::shared_ptr<const Emulsion> emulsion{};  // the film; null: none
    int frame_x0 = 0, frame_y0 = 0;              // corner of the picture's frame
    Dodging dodging;                             // brighter and darker parts
    std::shared_ptr<Rows> light{};               // what the picture's light becomes before it is printed; null: it stays
};

// True if blocks are printed beside the picture's pixels, which takes memory for another block per thread.
bool needs_second_block(const std::vector<Exposure>& exposures, const PassSettings& settings);

// Bytes of grain that each thread holds for a block of this size.
std::size_t emulsion_bytes(const PassSettings& settings, int width, int height);

// Luminances of all pixels of `plan`. Errors: of reading.
Result<color::LuminanceHistogram> measure(const Source& source, const BandPlan& plan, const std::array<double, 3>& y_row,
                                          const Progress& progress);

// What came of each exposure, in their order. Bands go through printing and encoding one after
// another; where memory allows, one is printed while the one before is encoded. Errors: of reading, of the sinks.
Result<PassReport> print_all(const Source& source, const BandPlan& plan, const std::vector<Exposure>& exposures,
                             const PassSettings& settings, const Progress& progress);

}  // namespace latent::convert
