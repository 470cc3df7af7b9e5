// tools/convert/sink.h: one output of the tool: takes printed light band by band, encodes it for its format, writes it.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "image/rect.h"
#include "tools/convert/display.h"
#include "tools/convert/options.h"
#include "tools/convert/pyramid.h"

namespace latent::convert {

// A rectangle of the print in linear display light, in three planes.
struct PrintedBlock {
    image::Rect area;
    std::array<const float*, 3> planes;
    std::size_t row_stride = 0;

    std::span<const float> row(std::size_t c, int y) const {
        return {planes[c] + static_cast<std::size_t>(y - area.y0) * row_stride, static_cast<std::size_t>(area.width())};
    }
};

// Some rows of the whole width, on their way into one output.
struct Band {
    image::Rect area;
    Bytes codes;        // as the file will hold them: interleaved RGB
    PlanarRows halved;  // level 1 of a pyramid, if there is one
};

// The picture that all outputs show.
struct PrintedPicture {
    image::Rect area;            // coordinates of the display window
    image::Rect display_window;  // EXR keeps it
    double sigma = 1;
    color::Chromaticity white;  // printed neutral
    std::string observer{};     // that the pixels were made for; "": unknown
    std::string film{};         // and its print; "": not on film
    std::string recipe{};       // base/recipe.h; "": none
};

class Sink {
 public:
    virtual ~Sink() = default;
    // Bytes of memory: for each row of a band, and for what it holds besides.
    virtual std::size_t bytes_per_row() const = 0;
    virtual std::size_t bytes_held() const = 0;

    virtual Band new_band(const image::Rect& area) const = 0;
    // From many threads at once, for blocks that do not overlap and begin at even distances from the picture's corner.
    virtual void take(Band& band, const PrintedBlock& block) const = 0;
    // Bands from the top, one at a time; then once `finish` and once `publish`.
    virtual Status write(Band& band) = 0;
    virtual Status finish() = 0;
    virtual Status publish() = 0;
};

// Whether all outputs are of types that can be written, and any of them can have the depth that was asked for. The others get
// their own, which `notes` tells. Errors: kUsage.
Status check_types(const ConvertOptions& options, std::vector<std::string>& notes);

// The output `path` by its extension, of those that `check_types` accepts. Errors: kUsage, kExists, kOutOfRange (JPEG), kIo.
Result<std::unique_ptr<Sink>> open_sink(const std::filesystem::path& path, const PrintedPicture& picture, const Display& display,
                                        const ConvertOptions& options);

// What a PNG of 8 bits would hold goes to `codes`, which is empty. Errors: kUsage, the profile is one of inks.
Result<std::unique_ptr<Sink>> code_sink(CodeValues& codes, const PrintedPicture& picture, const Display& display,
                                        const ConvertOptions& options);

}  // namespace latent::convert
