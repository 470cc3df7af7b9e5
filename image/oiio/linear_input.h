// image/oiio/linear_input.h: a picture file as OpenImageIO's cache is to see it: linear floating-point values.
#pragma once

#include <OpenImageIO/imageio.h>

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "image/pictures.h"

namespace latent::image {

// Values of a file that are NaN or infinite. What is read again is not counted again. Any thread.
class RefusedValues {
 public:
    void add(const std::array<int, 3>& place, std::uint64_t count) {
        const std::lock_guard lock(mutex_);
        if (places_.insert(place).second) count_ += count;
    }
    std::uint64_t count() const {
        const std::lock_guard lock(mutex_);
        return count_;
    }

 private:
    mutable std::mutex mutex_;
    std::set<std::array<int, 3>> places_;
    std::uint64_t count_ = 0;
};

// OpenImageIO filters what a file holds, which is not light where integers are encoded. So the cache reads through this.
class LinearInput final : public OIIO::ImageInput {
 public:
    // The file and its encoding are attributes of the configuration that the cache passes to `open`. With `refused`, which outlives
    // the input, values that are NaN or infinite become 0 and are counted there.
    static OIIO::ImageSpec configuration(const std::string& path, const PictureEncoding& encoding,
                                         RefusedValues* refused = nullptr);
    static OIIO::ImageInput* create() { return new LinearInput; }

    const char* format_name() const override { return "linear"; }
    int supports(OIIO::string_view) const override { return 0; }
    bool open(const std::string& name, OIIO::ImageSpec& spec, const OIIO::ImageSpec& config) override;
    bool open(const std::string& name, OIIO::ImageSpec& spec) override { return open(name, spec, {}); }
    bool close() override;
    int current_subimage() const override { return 0; }
    int current_miplevel() const override { return level_; }
    bool seek_subimage(int subimage, int miplevel) override;
    bool read_native_scanline(int subimage, int miplevel, int y, int z, void* data) override;
    bool read_native_scanlines(int subimage, int miplevel, int ybegin, int yend, int z, void* data) override;
    bool read_native_tile(int subimage, int miplevel, int x, int y, int z, void* data) override;

 private:
    void take_spec();
    // Handles the `pixels` from (x, y) on.
    bool finish(bool read, float* values, std::size_t pixels, int x, int y);

    std::unique_ptr<OIIO::ImageInput> file_;
    int level_ = 0;
    bool is_encoded_ = false;
    bool is_grey_with_alpha_ = false;  // in the file: here it is RGBA
    PictureEncoding encoding_;
    RefusedValues* refused_ = nullptr;
    std::vector<float> table_;  // linear values of 8 bits
};

}  // namespace latent::image
