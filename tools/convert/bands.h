// tools/convert/bands.h: the bands of a picture of any size, which passes through a fixed amount of memory.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/result.h"
#include "image/exr_reader.h"

namespace latent::convert {

// Bands are rows of the whole width, from the top; each is cut into blocks, which threads print side by side. Both end where the
// file's own blocks end, as far as the distance from the picture's corner stays even (pyramids pair rows and columns).
struct BandPlan {
    image::Rect area;
    std::vector<int> band_ends;  // y where each band ends
    bool overlapped = false;     // a band is printed while the one before it is encoded
    int block_step_x = 0, block_step_y = 0, origin_x = 0, origin_y = 0;

    image::Rect band(std::size_t index) const;
    std::vector<image::Rect> blocks(const image::Rect& band) const;
};

// What the outputs need per row of a band, and besides.
struct MemoryNeed {
    std::size_t bytes_per_row = 0, bytes_held = 0;
    bool second_block = false;  // each thread holds two
    std::function<std::size_t(int width, int height)>
        beside_block{};  // bytes that each thread holds for a block of this size; or null
};

// What `threads` hold while they read the blocks of a picture side by side.
std::size_t bytes_to_read(const image::ExrImage& image, const image::Rect& area, int threads);

// Errors: kUsage if the smallest bands do not fit `memory`, with the amount that would do.
Result<BandPlan> plan_bands(const image::ExrImage& image, const image::Rect& area, const MemoryNeed& need, std::uint64_t memory,
                            int threads);

}  // namespace latent::convert
