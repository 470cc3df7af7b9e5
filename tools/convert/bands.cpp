#include "tools/convert/bands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

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

std::size_t pixels(int width, int height) { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }

bool is_tiled(const image::ExrImage& image) { return image.block_width < image.data_window.width(); }

// Width and height of blocks.
std::array<int, 2> block_steps(const image::ExrImage& image, const Rect& area) {
    if (is_tiled(image)) return {multiple(image.block_width, 256), multiple(image.block_height, 256)};
    const int rows = multiple(image.block_height, kBlockPixels / area.width());
    return {area.width(), rows % 2 == 1 ? 2 * rows : rows};
}

}  // namespace

// One block of floats, and up to three times the file's block while it is decompressed.
std::size_t bytes_to_read(const image::ExrImage& image, const Rect& area, int threads) {
    const auto [step_x, step_y] = block_steps(image, area);
    return static_cast<std::size_t>(threads) * 12 *
           (pixels(std::min(step_x, area.width()), std::min(step_y, area.height())) +
            3 * pixels(image.block_width, image.block_height));
}

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
    const auto [step_x, step_y] = block_steps(image, area);
    plan.block_step_x = step_x, plan.block_step_y = step_y;
    plan.origin_x = is_tiled(image) ? image.data_window.x0 : area.x0;
    plan.origin_y = image.data_window.y0;

    const int width = std::min(step_x, area.width()), rows = std::min(step_y, area.height());
    const std::size_t second = need.second_block ? 12 * pixels(width, rows) : 0;
    const std::size_t beside = need.beside_block ? need.beside_block(width, rows) : 0;
    const std::size_t fixed =
        need.bytes_held + static_cast<std::size_t>(threads) * (second + beside) + bytes_to_read(image, area, threads);
    int height = std::min(multiple(plan.block_step_y, kBandPixels / area.width()), multiple(2, area.height()));
    const auto fits = [&](int band_rows, std::size_t bands) {
        return fixed + bands * static_cast<std::size_t>(band_rows) * need.bytes_per_row <= memory;
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
