#include "tools/convert/bands.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/size.h"

namespace latent::convert {

using image::Rect;

namespace {

constexpr int kBlockPixels = 1 << 16;  // a block's planes stay in a processor's cache
constexpr int kBandPixels = 1 << 22;   // enough blocks for all threads

// Ends of pieces of `step` from `origin` between `begin` and `end`, each at an even distance from `begin`; the last is `end`.
std::vector<int> cuts(int begin, int end, int origin, int step) {
    std::vector<int> ends;
    const long long first = origin + static_cast<long long>((begin - origin) / step + 1) * step;
    for (long long at = first; at < end; at += step) {
        const int even = begin + ((static_cast<int>(at) - begin + 1) & ~1);
        if (even < end && even > (ends.empty() ? begin : ends.back())) ends.push_back(even);
    }
    ends.push_back(end);
    return ends;
}

// The multiple of `unit` nearest above `wanted`.
int multiple(int unit, long long wanted) { return static_cast<int>(std::max<long long>(1, (wanted + unit - 1) / unit)) * unit; }

}  // namespace

Rect BandPlan::band(std::size_t index) const {
    return {area.x0, index == 0 ? area.y0 : band_ends[index - 1], area.x1, band_ends[index]};
}

std::vector<Rect> BandPlan::blocks(const Rect& band) const {
    std::vector<Rect> out;
    int y0 = band.y0;
    for (const int y1 : cuts(band.y0, band.y1, origin_y, block_step_y)) {
        int x0 = band.x0;
        for (const int x1 : cuts(band.x0, band.x1, origin_x, block_step_x)) {
            out.push_back({x0, y0, x1, y1});
            x0 = x1;
        }
        y0 = y1;
    }
    return out;
}

Result<BandPlan> plan_bands(const image::ExrImage& image, const Rect& area, const MemoryNeed& need, std::uint64_t memory,
                            int threads) {
    BandPlan plan;
    plan.area = area;
    plan.origin_x = image.data_window.x0;
    plan.origin_y = image.data_window.y0;
    const bool tiled = image.block_width < image.data_window.width();
    plan.block_step_x = tiled ? multiple(image.block_width, 256) : area.width();
    plan.block_step_y = multiple(image.block_height, tiled ? 256 : kBlockPixels / area.width());
    if (!tiled && plan.block_step_y % 2 == 1) plan.block_step_y *= 2;
    if (!tiled) plan.origin_x = area.x0;

    // Each thread holds one block of floats, and up to three times the file's block while it is decompressed.
    const std::size_t block = (need.second_block ? 24 : 12) * static_cast<std::size_t>(std::min(plan.block_step_x, area.width())) *
                              static_cast<std::size_t>(std::min(plan.block_step_y, area.height()));
    const std::size_t beside =
        need.beside_block ? need.beside_block(std::min(plan.block_step_x, area.width()), std::min(plan.block_step_y, area.height()))
                          : 0;
    const std::size_t file_block = 12 * static_cast<std::size_t>(image.block_width) * static_cast<std::size_t>(image.block_height);
    const std::size_t fixed = need.bytes_held + static_cast<std::size_t>(threads) * (block + beside + 3 * file_block);
    int height = std::min(multiple(plan.block_step_y, kBandPixels / area.width()), multiple(2, area.height()));
    const auto fits = [&](int rows, std::size_t bands) {
        return fixed + bands * static_cast<std::size_t>(rows) * need.bytes_per_row <= memory;
    };
    plan.overlapped = threads > 1 && fits(height, 2);
    while (!fits(height, 1) && height > 2) height = multiple(2, height / 2);
    if (!fits(height, 1)) {
        const std::size_t needed = fixed + 2 * need.bytes_per_row;
        return usage_error(
            fmt::format("--memory: too small; a picture {} pixels wide needs at least {}M", area.width(), (needed >> 20) + 1));
    }
    plan.block_step_y = std::min(plan.block_step_y, height);
    plan.band_ends = cuts(area.y0, area.y1, plan.origin_y, height);
    return plan;
}

}  // namespace latent::convert
