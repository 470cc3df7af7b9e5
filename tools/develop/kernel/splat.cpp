#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tools/develop/kernel/splat.cpp"
#include "tools/develop/kernel/splat.h"

#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

#include <algorithm>

#include "tools/develop/kernel/weights-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latent::develop::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Form = FilterKernel::Form;
constexpr std::size_t kReadable = Segment::kReadable / sizeof(float);  // lanes

// What is known of the sums when this file is compiled; 0: only at run time.
template <int kSideOrZero, int kStrideOrZero, Weights kWeightsUsed>
struct Shape {
    static constexpr int kSide = kSideOrZero;
    static constexpr Weights kWeights = kWeightsUsed;
    static constexpr bool kMayBeSquared = kStrideOrZero == 0;
    int run_side;
    EntryCounts entries;
    int side() const { return kSideOrZero > 0 ? kSideOrZero : run_side; }
    int stride() const { return kStrideOrZero > 0 ? kStrideOrZero : entries.stride(); }
    int added() const { return kStrideOrZero > 0 ? kStrideOrZero : entries.added(); }
    // Weight of an entry where the filter weighs w. What is known when compiled has linear entries alone.
    HWY_INLINE double weight(double w, int entry) const {
        if (kStrideOrZero > 0 || entry < entries.linear) return w;
        return entry < entries.linear + entries.squared ? w * w : w != 0 ? 1 : 0;
    }
    // Weights are computed for so many pixels: a footprint of 2 x 2 fills a vector of four, others have room for the widest.
    std::size_t padded() const { return side() == 2 ? 4 : (static_cast<std::size_t>(side()) * side() + 15) / 16 * 16; }
    auto tag() const { return hn::CappedTag < float, kSideOrZero == 2 ? 4 : 16 > (); }
};

// 1 / sum of the weights, added in one order everywhere; of 3 x 3 pixels in that of the 4 x 4 which they cover.
HWY_INLINE double inverse_sum(const double* weights, int side) {
    if (side == 3) {
        const auto column = [&](int x) { return (weights[x] + weights[x + 3]) + weights[x + 6]; };
        return 1.0 / ((column(0) + column(2)) + column(1));
    }
    double part[4] = {};
    for (int k = 0; k < side * side; k += 4) {  // other footprints have 4 n^2 pixels
        for (int i = 0; i < 4; ++i) part[i] += weights[k + i];
    }
    return 1.0 / ((part[0] + part[2]) + (part[1] + part[3]));
}

// Adds w s to the sums of all pixels of one footprint. Where s is a float32, so is w, and their product is exact in float64: fused
// with the addition or not, the sum has the same bits. Products with w^2 are rounded before they are added.
template <class Shape>
HWY_INLINE void add(const Shape& shape, const double* HWY_RESTRICT weights, const float* HWY_RESTRICT values,
                    double* HWY_RESTRICT window, std::size_t row_pixels) {
    const hn::CappedTag<double, 4> d;
    const hn::Rebind<float, decltype(d)> df;
    const double scale = Shape::kWeights == Weights::kUnitSum ? inverse_sum(weights, shape.side()) : 1;
    for (int entry = 0; entry < shape.added(); entry += static_cast<int>(hn::Lanes(d))) {
        const auto value = hn::LoadU(df, values + entry);
        if (Shape::kMayBeSquared && entry > 0 && hn::AllTrue(df, hn::Eq(value, hn::Zero(df)))) continue;  // it adds nothing
        auto s = hn::PromoteTo(d, value);
        if constexpr (Shape::kWeights == Weights::kUnitSum) s = hn::Mul(s, hn::Set(d, scale));
        double* row = window + entry;
        const double* w = weights;
        const auto add_pixel = [&](int x) HWY_ATTR {
            double* sums = row + x * shape.stride();
            const auto before = hn::LoadU(d, sums), weight = hn::Set(d, shape.weight(w[x], entry));
            if (Shape::kWeights == Weights::kUnitSum || (Shape::kMayBeSquared && entry >= shape.entries.linear))
                hn::StoreU(hn::Add(hn::Mul(weight, s), before), d, sums);
            else
                hn::StoreU(hn::MulAdd(weight, s, before), d, sums);
        };
        for (int y = 0; y < shape.side(); ++y, row += row_pixels * shape.stride(), w += shape.side()) {
            if constexpr (Shape::kSide == 4) {
                add_pixel(0);
                add_pixel(1);
                add_pixel(2);
                add_pixel(3);
            } else if constexpr (Shape::kSide == 3) {
                add_pixel(0);
                add_pixel(1);
                add_pixel(2);
            } else if constexpr (Shape::kSide == 2) {
                add_pixel(0);
                add_pixel(1);
            } else {
                for (int x = 0; x < shape.side(); ++x) add_pixel(x);
            }
        }
    }
    if (!Shape::kMayBeSquared || shape.entries.chosen == 0) return;
    double* row = window + shape.added();
    const float* chosen = values + shape.added();
    for (int y = 0; y < shape.side(); ++y, row += row_pixels * shape.stride(), weights += shape.side()) {
        for (int x = 0; x < shape.side(); ++x)
            choose(weights[x] * static_cast<double>(chosen[0]), static_cast<double>(chosen[1]), static_cast<double>(chosen[2]),
                   row + x * shape.stride());
    }
}

// Footprints of an odd number of pixels begin at the first pixel that is in reach of g, or the one after it: from g = 1/2 on.
constexpr std::uint32_t kHalf = 1 << 23;

// Some records of a cell: where their footprints begin, and what they hold.
constexpr std::size_t kBlock = 64;
struct Block {
    std::size_t count = 0;
    HWY_ALIGN float gx[kBlock + kReadable], gy[kBlock + kReadable];
    HWY_ALIGN std::uint32_t pixel[kBlock + kReadable];  // pixels of the window
    const float* values[kBlock];
};

// Fills blocks with the records of segments, one after another.
class BlockReader {
 public:
    BlockReader(std::span<const Segment> segments, std::size_t row_pixels, int stride)
        : segments_(segments), row_pixels_(static_cast<std::uint32_t>(row_pixels)), stride_(stride) {}

    // `shift`: added to positions, in units of 2^-24 pixels. False if there are no more records.
    bool read(std::uint32_t shift, Block& block) {
        block.count = 0;
        while (!segments_.empty() && block.count < kBlock) {
            const Segment& segment = segments_.front();
            if (done_ == 0 && segments_.size() > kSegmentsAhead) {
                hwy::Prefetch(segments_[kSegmentsAhead].memory);
                hwy::Prefetch(segments_[kSegmentsAhead].memory + 64);
            }
            const std::size_t n = std::min<std::size_t>(segment.count - done_, kBlock - block.count);
            read_rows(segment.columns(), done_, n, shift, block);
            done_ += static_cast<std::uint32_t>(n);
            if (done_ == segment.count) segments_ = segments_.subspan(1), done_ = 0;
        }
        return block.count > 0;
    }

 private:
    static constexpr std::size_t kSegmentsAhead = 16;  // to be fetched: short ones are far from each other in memory

    HWY_INLINE void read_rows(const SegmentColumns& records, std::size_t first, std::size_t n, std::uint32_t shift, Block& block) {
        const hn::CappedTag<std::uint32_t, kReadable> d;
        const hn::Rebind<float, decltype(d)> df;
        const hn::Rebind<std::int32_t, decltype(d)> di;
        const auto shifts = hn::Set(d, shift), fraction = hn::Set(d, 0xFFFFFF), row = hn::Set(d, row_pixels_);
        const auto unit = hn::Set(df, 0x1p-24f);
        for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {  // those behind the last one are overwritten, or not used
            const auto x = hn::Add(hn::LoadU(d, records.x + first + i), shifts);
            const auto y = hn::Add(hn::LoadU(d, records.y + first + i), shifts);
            const std::size_t to = block.count + i;
            hn::StoreU(hn::Mul(hn::ConvertTo(df, hn::BitCast(di, hn::And(x, fraction))), unit), df, block.gx + to);
            hn::StoreU(hn::Mul(hn::ConvertTo(df, hn::BitCast(di, hn::And(y, fraction))), unit), df, block.gy + to);
            hn::StoreU(hn::Add(hn::Mul(hn::ShiftRight<24>(y), row), hn::ShiftRight<24>(x)), d, block.pixel + to);
        }
        const float* values = records.values + first * static_cast<std::size_t>(stride_);
        for (std::size_t i = 0; i < n; ++i, values += stride_) block.values[block.count + i] = values;
        block.count += n;
    }

    std::span<const Segment> segments_;
    std::uint32_t row_pixels_;
    int stride_;
    std::uint32_t done_ = 0;  // rows of the first segment
};

// Both steps of the weights of later records are taken while the sums of a record are under way: additions wait for memory, weights
// for square roots.
template <Form kForm, class Shape>
void splat_records(const Shape& shape, const FilterKernel& filter, std::span<const Segment> segments, double* window,
                   std::size_t row_pixels) {
    constexpr std::size_t kAhead = 2, kRing = 8;
    constexpr std::size_t kMaxWeights = Shape::kSide > 0 ? 16 : 4 * FilterKernel::kMaxReach * FilterKernel::kMaxReach;
    HWY_ALIGN float begun[kRing * kMaxWeights];
    HWY_ALIGN double weights[kRing * kMaxWeights];
    const std::size_t padded = shape.padded();
    Block block;
    const auto begin = [&](std::size_t i) HWY_ATTR {
        if (i < block.count)
            begin_weights<kForm>(shape.tag(), filter, padded, block.gx[i], block.gy[i], begun + i % kRing * padded);
    };
    const auto end = [&](std::size_t i) HWY_ATTR {
        if (i < block.count)
            end_weights<kForm, Shape::kWeights == Weights::kPositive>(shape.tag(), filter, padded, begun + i % kRing * padded,
                                                                      weights + i % kRing * padded);
    };
    const std::uint32_t shift = shape.side() == 3 ? kHalf : 0;
    for (BlockReader reader(segments, row_pixels, shape.stride()); reader.read(shift, block);) {
        for (std::size_t i = 0; i < 2 * kAhead; ++i) begin(i);
        for (std::size_t i = 0; i < kAhead; ++i) end(i);
        for (std::size_t i = 0; i < block.count; ++i) {
            begin(i + 2 * kAhead);
            end(i + kAhead);
            add(shape, weights + i % kRing * padded, block.values[i],
                window + std::size_t{block.pixel[i]} * static_cast<std::size_t>(shape.stride()), row_pixels);
        }
    }
}

// The box: each record counts for the pixel that it lies in, with weight 1, which is also the sum of its weights. The record that
// is chosen is the one nearest to the centre.
void splat_box(const EntryCounts& entries, std::span<const Segment> segments, double* window, std::size_t row_pixels) {
    const hn::CappedTag<double, 4> d;
    const hn::Rebind<float, decltype(d)> df;
    Block block;
    const int stride = entries.stride(), added = entries.added();
    for (BlockReader reader(segments, row_pixels, stride); reader.read(kHalf, block);) {
        for (std::size_t i = 0; i < block.count; ++i) {
            double* const sums = window + std::size_t{block.pixel[i]} * static_cast<std::size_t>(stride);
            for (int entry = 0; entry < added; entry += static_cast<int>(hn::Lanes(d))) {
                const auto s = hn::PromoteTo(d, hn::LoadU(df, block.values[i] + entry));
                hn::StoreU(hn::Add(hn::LoadU(d, sums + entry), s), d, sums + entry);
            }
            if (entries.chosen == 0) continue;
            const float* const chosen = block.values[i] + added;
            const float x = block.gx[i] - 0.5f, y = block.gy[i] - 0.5f;
            choose(static_cast<double>((1 - (x * x + y * y)) * chosen[0]), static_cast<double>(chosen[1]),
                   static_cast<double>(chosen[2]), sums + added);
        }
    }
}

void Splat(const FilterKernel& filter, const EntryCounts& entries, Weights weights, std::span<const Segment> segments,
           double* window, std::size_t row_pixels) {
    const auto with_shape = [&](const auto& shape) {
        switch (filter.form) {
            case Form::kQuartic:
                return splat_records<Form::kQuartic>(shape, filter, segments, window, row_pixels);
            case Form::kTable:
                return splat_records<Form::kTable>(shape, filter, segments, window, row_pixels);
            case Form::kSeparable:
                return splat_records<Form::kSeparable>(shape, filter, segments, window, row_pixels);
            case Form::kBox:
                return splat_box(shape.entries, segments, window, row_pixels);
        }
    };
    const int side = filter.covered;
    const int known_stride = entries.linear == entries.stride() ? entries.stride() : 0;
    const auto with_size = [&]<Weights kWeights>() {
        if (side == 4 && known_stride == 4) return with_shape(Shape<4, 4, kWeights>{side, entries});
        if (side == 3 && known_stride == 4) return with_shape(Shape<3, 4, kWeights>{side, entries});
        if (side == 2 && known_stride == 4) return with_shape(Shape<2, 4, kWeights>{side, entries});
        // Shapes of the default filter: with halves; with halves and what the denoiser knows of surfaces; with any layers.
        if (side == 3 && known_stride == 8) return with_shape(Shape<3, 8, kWeights>{side, entries});
        if (side == 3 && known_stride == 16) return with_shape(Shape<3, 16, kWeights>{side, entries});
        if (side == 3) return with_shape(Shape<3, 0, kWeights>{side, entries});
        return with_shape(Shape<0, 0, kWeights>{side, entries});
    };
    switch (weights) {
        case Weights::kSigned:
            return with_size.template operator()<Weights::kSigned>();
        case Weights::kPositive:
            return with_size.template operator()<Weights::kPositive>();
        case Weights::kUnitSum:
            return with_size.template operator()<Weights::kUnitSum>();
    }
}

// Appends the rows from `first` on whose footprints begin in columns x0 .. x0 + width - 1 and rows y0 .. y0 + height - 1 to
// `chosen` (mod 256), until it holds `most` or there are no more. Returns the first row that it has not looked at.
std::uint32_t Choose(const SegmentColumns& records, std::uint32_t first, std::uint32_t end, const PixelRect& places,
                     std::vector<std::uint32_t>& chosen, std::size_t most) {
    const hn::ScalableTag<std::uint32_t> d;
    const std::size_t lanes = hn::Lanes(d);
    const auto x0 = static_cast<std::uint32_t>(places.x0) << 24, y0 = static_cast<std::uint32_t>(places.y0) << 24;
    const auto width = static_cast<std::uint32_t>(places.width()), height = static_cast<std::uint32_t>(places.height());
    const auto columns = hn::Set(d, width), rows = hn::Set(d, height), left = hn::Set(d, x0), top = hn::Set(d, y0);
    std::uint32_t i = first;
    while (i < end && chosen.size() < most) {
        std::uint32_t stop = std::min<std::uint32_t>(i + static_cast<std::uint32_t>(lanes), end);
        if (stop - i == lanes) {
            const auto x = hn::ShiftRight<24>(hn::Sub(hn::LoadU(d, records.x + i), left));
            const auto y = hn::ShiftRight<24>(hn::Sub(hn::LoadU(d, records.y + i), top));
            if (hn::AllFalse(d, hn::And(hn::Lt(x, columns), hn::Lt(y, rows)))) {
                i = stop;
                continue;
            }
        }
        for (; i < stop; ++i) {
            if ((records.x[i] - x0) >> 24 < width && (records.y[i] - y0) >> 24 < height) chosen.push_back(i);
        }
    }
    return i;
}

}  // namespace latent::develop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <utility>

#include "base/simd.h"
#include "base/simd_dispatch.h"

namespace latent::develop {

LATENT_SIMD_EXPORT(Splat);
LATENT_SIMD_EXPORT(Choose);

void splat(const FilterKernel& filter, const EntryCounts& entries, Weights weights, std::span<const Segment> segments,
           double* window, std::size_t row_pixels) {
    LATENT_SIMD_CALL(Splat)(filter, entries, weights, segments, window, row_pixels);
}

void splat_patch(const FilterKernel& filter, const EntryCounts& entries, Weights weights, std::span<const Segment> segments,
                 const PixelRect& pixels, double* patch) {
    constexpr std::size_t kAtOnce = 256;
    thread_local std::vector<std::uint32_t> chosen;
    thread_local std::vector<std::byte> memory;
    thread_local std::vector<Segment> copies;
    const PixelRect reach = patch_of(filter, pixels);
    const auto stride = static_cast<std::size_t>(entries.stride());
    const PixelRect places{reach.x0, reach.y0, pixels.x1, pixels.y1};                // where footprints that reach `pixels` begin
    memory.resize(SegmentColumns::bytes(2 * kAtOnce, stride) + Segment::kReadable);  // Choose may find some too many
    std::size_t rows = 0;
    const auto flush = [&] {
        splat(filter, entries, weights, copies, patch, static_cast<std::size_t>(reach.width()));
        copies.clear(), rows = 0;
    };
    for (const Segment& segment : segments) {
        const SegmentColumns records = segment.columns();
        for (std::uint32_t row = 0; row < segment.count;) {
            chosen.clear();
            row = LATENT_SIMD_CALL(Choose)(records, row, segment.count, places, chosen, kAtOnce - rows);
            if (chosen.empty()) continue;
            copies.push_back(
                {segment.page, memory.data() + SegmentColumns::bytes(rows, stride), static_cast<std::uint32_t>(chosen.size())});
            const SegmentColumns to = copies.back().columns();
            for (std::size_t i = 0; i < chosen.size(); ++i) {
                to.x[i] = records.x[chosen[i]] - (static_cast<std::uint32_t>(places.x0) << 24);
                to.y[i] = records.y[chosen[i]] - (static_cast<std::uint32_t>(places.y0) << 24);
                std::copy_n(records.values + chosen[i] * stride, stride, to.values + i * stride);
            }
            rows += chosen.size();
            if (rows >= kAtOnce) flush();
        }
    }
    flush();
}

namespace {
constexpr std::pair<std::string_view, std::int64_t> kLevels[] = {
    {"sse4.2", HWY_SSE4}, {"avx2", HWY_AVX2}, {"avx512", HWY_AVX3}, {"neon", HWY_NEON}, {"scalar", HWY_SCALAR}};
}  // namespace

std::vector<std::string_view> simd_levels() {
    std::vector<std::string_view> levels;
    for (const auto& [name, target] : kLevels) {
        if (simd_targets() & HWY_TARGETS & target) levels.push_back(name);
    }
    return levels;
}

Status set_simd_level(std::string_view level) {
    const Result<std::string_view> chosen = choose_simd(level, simd_levels(), "best");
    if (!chosen) return chosen.error();
    const auto* found = std::ranges::find(kLevels, *chosen, &std::pair<std::string_view, std::int64_t>::first);
    use_simd_targets(found != std::end(kLevels) ? found->second : simd_targets());
    return {};
}

}  // namespace latent::develop
#endif
