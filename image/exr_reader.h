// image/exr_reader.h: OpenEXR files of any size, read by rectangles from many threads at once.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/file.h"
#include "base/result.h"
#include "image/rect.h"

namespace latent::image {

// The film whose layers were exposed: the pixels are exposures in lux s.
struct ExposedFilm {
    std::string name;
    double exposure_index = 0;  // within 0.01..1e6
    double push = 0;            // stops, within -1..2
};

// What the header says of the picture.
struct ExrImage {
    Rect data_window;         // pixels that the file stores at the chosen mip level
    Rect display_window;      // the whole picture, in the same coordinates
    int block_width = 0;      // pixels are compressed in blocks of this size that start at the data window's corner:
    int block_height = 0;     // tiles, or some whole rows
    int levels = 1;           // mip levels in the file
    bool has_colour = false;  // there are channels R, G, B; or X, Y, Z; or Y alone (grey)
    bool xyz = false;         // X, Y, Z
    bool grey = false;        // Y alone
    // Red, green, blue and white as x, y; absent if the file is silent (or `xyz`).
    std::optional<std::array<float, 8>> chromaticities;
    std::optional<std::array<float, 2>> adopted_neutral;  // x, y of what counts as white in the scene
    std::optional<double> white_luminance{};              // cd/m^2 of (1, 1, 1)
    std::string observer;                                 // that it was developed with; "" if the file is silent
    std::string recipe{};                                 // the same; base/recipe.h
    std::optional<ExposedFilm> film{};                    // that was exposed
    std::vector<double> emitted_nm{};                     // wavelengths of channels of emitted light [Fichet21], increasing
};

// What is wanted of a file.
struct ExrChoice {
    int level = 0;          // level 0 is the full picture, level n has 1/2^n of its sides
    std::string layer{};    // channels LAYER.R, LAYER.G, LAYER.B; "": those without a layer
    bool spectrum = false;  // a spectrum will do, too
};

class ExrReader {
 public:
    // Channels: R, G, B; or X, Y, Z; or Y; half or float. Errors: kNotFound, kIo, kCorrupt, kForeign (not an EXR), kUnsupported
    // (deep, subsampled or other channels, DWA), kUsage (no such level or layer).
    static Result<ExrReader> open(const std::filesystem::path& path, const ExrChoice& choice = {});
    // Reads a file that is open, perhaps without a name. Errors call it `path`.
    static Result<ExrReader> open(std::shared_ptr<const latent::File> file, const std::filesystem::path& path,
                                  const ExrChoice& choice = {});
    ExrReader(ExrReader&&) noexcept;
    ~ExrReader();

    const ExrImage& image() const;

    // From now on, planes are sums of the channels of ExrImage::emitted_nm, each of which has three weights.
    void integrate(std::vector<std::array<float, 3>> weights);

    const std::filesystem::path& path() const;

    // Buffers of one thread, kept from call to call; they must not outlive the reader.
    class Scratch {
     public:
        Scratch();
        Scratch(Scratch&&) noexcept;
        ~Scratch();

     private:
        friend class ExrReader;
        struct State;
        std::unique_ptr<State> state_;
    };

    // Reads `area`, which lies in the data window, into three planes whose rows are `row_stride` floats apart: of the colour
    // channels, unless they are integrated. A block that
    // `area` touches is decoded whole if it is compressed. Errors: kIo, kTruncated, kCorrupt, naming the file and the block.
    Status read(const Rect& area, const std::array<float*, 3>& planes, std::size_t row_stride, Scratch& scratch) const;

 private:
    struct File;
    explicit ExrReader(std::unique_ptr<File> file);
    std::unique_ptr<File> file_;
};

}  // namespace latent::image
