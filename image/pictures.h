// image/pictures.h: pictures in any format that OpenImageIO reads, filtered by footprints, tile by tile within a limit of memory.
// OpenImageIO comes in a module of its own, loaded when the first picture is: it takes 120 MB and 0.2 s to start.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"

namespace latent::image {

// How the integers of a file become linear values: as sRGB's curve says, or x^gamma. Floating-point files are linear.
struct PictureEncoding {
    bool is_srgb = true;
    float gamma = 1;
};

enum class PictureWrap : std::uint8_t { kRepeat, kBlack, kClamp, kMirror };
// kQuartic: rotationally symmetric in texels; between two of the smaller sizes as kTrilinear.
enum class PictureFilter : std::uint8_t { kPoint, kBilinear, kTrilinear, kEwa, kQuartic };
struct PictureSampling {
    std::array<PictureWrap, 2> wrap{};  // along s and t
    PictureFilter filter = PictureFilter::kBilinear;
    int max_anisotropy = 8;
};

struct PictureInfo {
    std::uint32_t index = 0;  // for `lookup`
    std::uint32_t width = 0, height = 0;
    std::uint32_t channels = 0;                            // 1: grey, 3: RGB, 4: RGBA, alpha not multiplied in
    std::uint64_t whole_bytes = 0;                         // decoded with its smaller sizes, if the file has no tiles; else 0
    bool is_opaque = true;                                 // alpha, if there is one, is 1 everywhere
    std::optional<std::array<float, 8>> chromaticities{};  // color/rgb_space.h
    bool is_white_neutral = false;                         // equal R, G and B are grey, whatever white these name
};

// Linear values, rows from the top.
struct WholePicture {
    PictureInfo info;
    std::vector<float> values{};
};

// Any thread may look up; pictures are opened one after the other.
class Pictures {
 public:
    // At most `cache_bytes` of decoded tiles are kept. Errors: kUnsupported if OpenImageIO's module cannot be loaded.
    static Result<std::unique_ptr<Pictures>> create(std::uint64_t cache_bytes);
    virtual ~Pictures() = default;

    // Another limit. That of a single tile, a sixteenth, stays what it was.
    virtual void set_cache_bytes(std::uint64_t cache_bytes) = 0;
    // Messages call it `in_messages`. Errors: kNotFound, kCorrupt, kUnsupported: channels that are no grey or RGB.
    virtual Result<PictureInfo> open(const std::string& path, const std::string& in_messages, const PictureEncoding& encoding) = 0;
    // The mean about (s, t), t = 0 at the top, over the ellipse with axes d0 and d1. Black if the file cannot be read: see
    // `status`.
    virtual void lookup(std::uint32_t index, const PictureSampling& sampling, float s, float t, const std::array<float, 2>& d0,
                        const std::array<float, 2>& d1, std::array<float, 4>& out) const = 0;
    // The first error of `lookup`.
    virtual Status status() const = 0;
    // One line for each file in which `lookup` has met values that are NaN or infinite: they count as 0.
    virtual std::vector<std::string> warnings() const = 0;
    // All of a picture at once, beside the cache. Errors: those of `open`.
    virtual Result<WholePicture> read(const std::string& path, const std::string& in_messages,
                                      const PictureEncoding& encoding) const = 0;
};

}  // namespace latent::image
