#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tools/develop/splat.cpp"
#include "tools/develop/splat.h"

#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

#include <algorithm>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace latent::develop::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Only Mul, Add, Sub, Min, Max and Sqrt, one after another as written (-ffp-contract=off): every instruction set rounds alike.
using FloatTag = hn::CappedTag<float, 16>;
using Floats = hn::Vec<FloatTag>;

HWY_INLINE Floats quartic(FloatTag d, const FilterKernel& f, Floats dx, Floats dy) {
    const Floats one = hn::Set(d, 1.0f);
    const Floats r2 = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
    const Floats rho = hn::Sqrt(hn::Min(hn::Mul(r2, hn::Set(d, f.inverse_radius2)), one));
    const Floats rest = hn::Sub(one, rho);
    const Floats inner = hn::Add(hn::Set(d, 2.0f), hn::Mul(rho, hn::Set(d, f.s)));
    return hn::Mul(hn::Mul(rest, rest), hn::Add(one, hn::Mul(rho, inner)));
}

HWY_INLINE Floats table(FloatTag d, const FilterKernel& f, Floats dx, Floats dy) {
    const hn::RebindToSigned<FloatTag> di;
    const Floats r2 = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
    const Floats t = hn::Min(hn::Mul(r2, hn::Set(d, f.table_scale)), hn::Set(d, static_cast<float>(FilterKernel::kTableSteps)));
    const auto i = hn::ConvertTo(di, t);
    const Floats fraction = hn::Sub(t, hn::ConvertTo(d, i));
    return hn::Add(hn::GatherIndex(d, f.table_value.data(), i), hn::Mul(fraction, hn::GatherIndex(d, f.table_step.data(), i)));
}

HWY_INLINE Floats cubic(FloatTag d, const float (&c)[4], Floats x) {
    const Floats upper = hn::Add(hn::Set(d, c[2]), hn::Mul(x, hn::Set(d, c[3])));
    return hn::Add(hn::Set(d, c[0]), hn::Mul(x, hn::Add(hn::Set(d, c[1]), hn::Mul(x, upper))));
}
HWY_INLINE Floats separable(FloatTag d, const FilterKernel& f, Floats dx, Floats dy) {
    const Floats one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f);
    const auto m = [&](Floats distance) HWY_ATTR {
        const Floats x = hn::Abs(distance);
        return hn::IfThenElse(hn::Lt(x, one), cubic(d, f.inner, x),
                              hn::IfThenElseZero(hn::Lt(x, two), cubic(d, f.outer, hn::Sub(two, x))));
    };
    return hn::Mul(m(dx), m(dy));
}

HWY_INLINE Floats box(FloatTag d, Floats dx, Floats dy) {
    const Floats half = hn::Set(d, 0.5f);
    const auto in = [&](Floats x) HWY_ATTR { return hn::And(hn::Gt(x, hn::Neg(half)), hn::Le(x, half)); };
    return hn::IfThenElseZero(hn::And(in(dx), in(dy)), hn::Set(d, 1.0f));
}

// Weights of the pixels of the footprint of a record at (gx, gy), row after row.
template <FilterKernel::Form kForm>
HWY_INLINE void weigh(const FilterKernel& f, std::size_t padded, float gx, float gy, float* HWY_RESTRICT weights) {
    const FloatTag d;
    const Floats x = hn::Set(d, gx), y = hn::Set(d, gy);
    for (std::size_t k = 0; k < padded; k += hn::Lanes(d)) {
        const Floats dx = hn::Sub(hn::LoadU(d, f.column.data() + k), x), dy = hn::Sub(hn::LoadU(d, f.row.data() + k), y);
        Floats w;
        if constexpr (kForm == FilterKernel::Form::kQuartic) w = quartic(d, f, dx, dy);
        if constexpr (kForm == FilterKernel::Form::kTable) w = table(d, f, dx, dy);
        if constexpr (kForm == FilterKernel::Form::kSeparable) w = separable(d, f, dx, dy);
        if constexpr (kForm == FilterKernel::Form::kBox) w = box(d, dx, dy);
        hn::StoreU(w, d, weights + k);
    }
}

// 1 / sum of the weights, added in one order everywhere.
HWY_INLINE double inverse_sum(const float* weights, int count) {
    double part[4] = {};
    for (int k = 0; k < count; k += 4) {  // footprints have 4 n^2 pixels
        for (int i = 0; i < 4; ++i) part[i] += static_cast<double>(weights[k + i]);
    }
    return 1.0 / ((part[0] + part[2]) + (part[1] + part[3]));
}

// What is known of the sums when this file is compiled; 0: only at run time.
template <int kSideOrZero, int kLanesOrZero, bool kSplitSums, bool kUnitWeights>
struct Shape {
    static constexpr int kSide = kSideOrZero;
    static constexpr bool kSplit = kSplitSums, kUnitSum = kUnitWeights;
    int run_side, run_lanes;
    int side() const { return kSideOrZero > 0 ? kSideOrZero : run_side; }
    int lanes() const { return kLanesOrZero > 0 ? kLanesOrZero : run_lanes; }
    int doubles() const { return kSplit ? 2 * lanes() : lanes(); }
    std::size_t padded() const { return (side() * side() + 15) / 16 * 16; }
};

// Adds w s to the sums of all pixels of one footprint.
template <class Shape>
HWY_INLINE void add(const Shape& shape, const float* HWY_RESTRICT weights, const float* HWY_RESTRICT values,
                    double* HWY_RESTRICT window, std::size_t row_pixels) {
    const hn::CappedTag<double, 4> d;
    const hn::Rebind<float, decltype(d)> df;
    for (int lane = 0; lane < shape.lanes(); lane += static_cast<int>(hn::Lanes(d))) {
        auto s = hn::PromoteTo(d, hn::LoadU(df, values + lane));
        if constexpr (Shape::kUnitSum) s = hn::Mul(s, hn::Set(d, inverse_sum(weights, shape.side() * shape.side())));
        double* row = window + lane;
        const float* w = weights;
        const auto add_pixel = [&](int x) HWY_ATTR {
            double* sums = row + x * shape.doubles();
            if constexpr (Shape::kSplit) {  // the sign bit of w, without a branch
                std::uint32_t bits;
                std::memcpy(&bits, w + x, sizeof bits);
                sums += (bits >> 31) * static_cast<std::uint32_t>(shape.lanes());
            }
            hn::StoreU(hn::Add(hn::LoadU(d, sums), hn::Mul(hn::PromoteTo(d, hn::Set(df, w[x])), s)), d, sums);
        };
        for (int y = 0; y < shape.side(); ++y, row += row_pixels * shape.doubles(), w += shape.side()) {
            if constexpr (Shape::kSide == 4) {
                add_pixel(0);
                add_pixel(1);
                add_pixel(2);
                add_pixel(3);
            } else {
                for (int x = 0; x < shape.side(); ++x) add_pixel(x);
            }
        }
    }
}

template <FilterKernel::Form kForm, class Shape>
void splat_records(const Shape& shape, const FilterKernel& filter, const RecordColumns& records, std::span<const Segment> segments,
                   double* window, std::size_t row_pixels) {
    constexpr std::size_t kWeights = 1024;  // weights of a few records at a time, so that the two loops below overlap
    alignas(64) float weights[kWeights];
    const std::size_t padded = shape.padded(), at_once = kWeights / padded;
    for (const Segment& segment : segments) {
        for (std::uint32_t done = 0; done < segment.count;) {
            const std::size_t first = segment.first + done;
            const std::size_t n = std::min<std::size_t>(segment.count - done, at_once);
            for (std::size_t i = 0; i < n; ++i) {
                const float gx = static_cast<float>(static_cast<std::int32_t>(records.x[first + i] & 0xFFFFFF)) * 0x1p-24f;
                const float gy = static_cast<float>(static_cast<std::int32_t>(records.y[first + i] & 0xFFFFFF)) * 0x1p-24f;
                weigh<kForm>(filter, padded, gx, gy, weights + i * padded);
            }
            for (std::size_t i = 0; i < n; ++i) {
                const std::size_t place = (records.y[first + i] >> 24) * row_pixels + (records.x[first + i] >> 24);
                add(shape, weights + i * padded, records.values + (first + i) * shape.lanes(), window + place * shape.doubles(),
                    row_pixels);
            }
            done += static_cast<std::uint32_t>(n);
        }
    }
}

void Splat(const FilterKernel& filter, const PixelSums& layout, bool unit_sum, const RecordColumns& records,
           std::span<const Segment> segments, double* window, std::size_t row_pixels) {
    const auto with_shape = [&](const auto& shape) {
        using Form = FilterKernel::Form;
        switch (filter.form) {
            case Form::kQuartic:
                return splat_records<Form::kQuartic>(shape, filter, records, segments, window, row_pixels);
            case Form::kTable:
                return splat_records<Form::kTable>(shape, filter, records, segments, window, row_pixels);
            case Form::kSeparable:
                return splat_records<Form::kSeparable>(shape, filter, records, segments, window, row_pixels);
            case Form::kBox:
                return splat_records<Form::kBox>(shape, filter, records, segments, window, row_pixels);
        }
    };
    const int side = filter.side(), lanes = layout.lanes;
    if (side == 4 && lanes == 4) {
        if (unit_sum) return with_shape(Shape<4, 4, false, true>{side, lanes});
        return layout.split ? with_shape(Shape<4, 4, true, false>{side, lanes})
                            : with_shape(Shape<4, 4, false, false>{side, lanes});
    }
    if (unit_sum) return with_shape(Shape<0, 0, false, true>{side, lanes});
    return layout.split ? with_shape(Shape<0, 0, true, false>{side, lanes}) : with_shape(Shape<0, 0, false, false>{side, lanes});
}

}  // namespace latent::develop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <utility>

#include "base/simd.h"

namespace latent::develop {

HWY_EXPORT(Splat);

void splat(const FilterKernel& filter, const PixelSums& layout, bool unit_sum, const RecordColumns& records,
           std::span<const Segment> segments, double* window, std::size_t row_pixels) {
    HWY_DYNAMIC_DISPATCH(Splat)(filter, layout, unit_sum, records, segments, window, row_pixels);
}

namespace {
constexpr std::pair<std::string_view, std::int64_t> kLevels[] = {
    {"sse4.2", HWY_SSE4}, {"avx2", HWY_AVX2}, {"avx512", HWY_AVX3}, {"neon", HWY_NEON}, {"scalar", HWY_SCALAR}};
}  // namespace

std::vector<std::string_view> simd_levels() {
    hwy::SetSupportedTargetsForTest(0);
    std::vector<std::string_view> levels;
    for (const auto& [name, target] : kLevels) {
        if (hwy::SupportedTargets() & HWY_TARGETS & target) levels.push_back(name);
    }
    return levels;
}

Status set_simd_level(std::string_view level) {
    const Result<std::string_view> chosen = choose_simd(level, simd_levels(), "best");
    if (!chosen) return chosen.error();
    const auto* found = std::ranges::find(kLevels, *chosen, &std::pair<std::string_view, std::int64_t>::first);
    if (found != std::end(kLevels)) hwy::SetSupportedTargetsForTest(found->second);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return {};
}

}  // namespace latent::develop
#endif
