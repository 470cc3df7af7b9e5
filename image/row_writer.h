// image/row_writer.h: the interface of all writers of display images: rows come in from the top, a complete file comes out.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/bytes.h"
#include "base/result.h"

namespace latent::image {

enum class SampleType : std::uint8_t { kU8, kU16, kF32 };

inline std::size_t sample_bytes(SampleType type) { return type == SampleType::kU8 ? 1 : type == SampleType::kU16 ? 2 : 4; }

// Interleaved samples, in the host's byte order: grey; or red, green, blue; or, of four channels, cyan, magenta, yellow, black,
// where 0 is no ink (TIFF and JPEG only).
struct PixelFormat {
    int width = 0, height = 0;
    SampleType sample = SampleType::kU8;
    int channels = 3;

    std::size_t pixel_bytes() const { return static_cast<std::size_t>(channels) * sample_bytes(sample); }
    std::size_t row_bytes() const { return static_cast<std::size_t>(width) * pixel_bytes(); }
};

// What the file says about its pixels. Nothing here may depend on the date, the host or a path.
struct ImageTags {
    Bytes icc;                                        // colour profile; empty for plain sRGB where the format can say that shorter
    bool srgb = false;                                // PNG: sRGB, gAMA and cHRM chunks instead of the profile
    std::optional<std::array<std::uint8_t, 4>> cicp;  // PNG: code points [H273] beside the profile
    std::vector<std::pair<std::string, std::string>> texts;  // key and value, in Latin letters
    int pixels_per_inch = 0;                                 // 0: nothing is said of its size on paper
};

class RowWriter {
 public:
    virtual ~RowWriter() = default;
    // The next rows from the top; any number of whole ones at a time, which does not change the file. After an error: nothing more.
    virtual Status write_rows(ByteSpan rows) = 0;
    // After the last row: completes the file, which then still has no name.
    virtual Status finish() = 0;
    // After `finish`: gives the file its name.
    virtual Status publish() = 0;
};

}  // namespace latent::image
