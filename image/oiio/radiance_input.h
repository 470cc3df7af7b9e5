// image/oiio/radiance_input.h: Radiance pictures (.hdr, .pic): RGBE and XYZE, flat and in both run-length encodings, in each order
// of rows and columns, without the exposure that their headers say was applied. OpenImageIO reads the usual ones alone, and some
// of the others upside down.
#pragma once

#include <OpenImageIO/imageio.h>

#include <array>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace latent::image {

// Three floats a pixel. "chromaticities" are the PRIMARIES of the header, if there are any, or for XYZE the axes of XYZ;
// "latent:neutral": their white is neutral, as Radiance has it.
class RadianceInput final : public OIIO::ImageInput {
 public:
    const char* format_name() const override { return "radiance"; }
    bool open(const std::string& path, OIIO::ImageSpec& spec) override;
    bool close() override;
    int current_subimage() const override { return 0; }
    int current_miplevel() const override { return 0; }
    bool seek_subimage(int subimage, int miplevel) override { return subimage == 0 && miplevel == 0; }
    bool read_native_scanline(int subimage, int miplevel, int y, int z, void* data) override;

 private:
    // Up to the line of the size. False: an error was set.
    bool read_header();
    // The next row of the file, from where `file_` is. False: the file is cut off or damaged.
    bool read_row();

    std::ifstream file_;
    int width_ = 0, height_ = 0;
    bool from_bottom_ = false, from_right_ = false, is_xyz_ = false;
    std::array<float, 3> scale_{1, 1, 1};  // what undoes the exposure
    std::optional<std::array<float, 8>> primaries_{};
    std::vector<std::streamoff> rows_{};  // where rows of the file begin, as far as they were read
    std::vector<std::array<unsigned char, 4>> row_{};
};

}  // namespace latent::image
