#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tools/develop/splat.cpp"
#include "tools/develop/splat.h"

#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

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
HWY_INLINE void weigh(const FilterKernel& f, float gx, float gy, float* HWY_RESTRICT weights) {
    const FloatTag d;
    const Floats x = hn::Set(d, gx), y = hn::Set(d, gy);
    for (std::size_t k = 0; k < f.column.size(); k += hn::Lanes(d)) {
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

// Adds w s to the sums of all pixels of one footprint. kSide and kLanes: the values, or 0 if only known at run time.
template <int kSide, int kLanes>
HWY_INLINE void add(const float* HWY_RESTRICT weights, const float* HWY_RESTRICT values, double scale, int run_side, int run_lanes,
                    bool split, double* HWY_RESTRICT window, std::size_t row_pixels) {
    const int side = kSide > 0 ? kSide : run_side, lanes = kLanes > 0 ? kLanes : run_lanes;
    const hn::CappedTag<double, 4> d;
    const hn::Rebind<float, decltype(d)> df;
    const int negative = split ? lanes : 0;
    const int pixel = split ? 2 * lanes : lanes;
    for (int lane = 0; lane < lanes; lane += static_cast<int>(hn::Lanes(d))) {
        const auto s = hn::Mul(hn::PromoteTo(d, hn::LoadU(df, values + lane)), hn::Set(d, scale));
        double* row = window + lane;
        const float* w = weights;
        for (int y = 0; y < side; ++y, row += row_pixels * pixel) {
            for (int x = 0; x < side; ++x, ++w) {
                double* sums = row + x * pixel + (*w < 0 ? negative : 0);
                hn::StoreU(hn::Add(hn::LoadU(d, sums), hn::Mul(hn::Set(d, static_cast<double>(*w)), s)), d, sums);
            }
        }
    }
}

template <FilterKernel::Form kForm, int kSide, int kLanes>
void splat_records(const FilterKernel& filter, const PixelSums& layout, bool unit_sum, const RecordColumns& records,
                   std::span<const Segment> segments, double* window, std::size_t row_pixels) {
    constexpr std::size_t kWeights = 1024;  // weights of a few records at a time, so that the two loops below overlap
    alignas(64) float weights[kWeights];
    const int side = filter.side(), count = side * side;
    const std::size_t padded = filter.column.size(), at_once = kWeights / padded;
    for (const Segment& segment : segments) {
        for (std::uint32_t done = 0; done < segment.count;) {
            const std::uint32_t first = segment.first + done;
            const std::uint32_t n = std::min<std::uint32_t>(segment.count - done, at_once);
            for (std::uint32_t i = 0; i < n; ++i) {
                const float gx = static_cast<float>(static_cast<std::int32_t>(records.x[first + i] & 0xFFFFFF)) * 0x1p-24f;
                const float gy = static_cast<float>(static_cast<std::int32_t>(records.y[first + i] & 0xFFFFFF)) * 0x1p-24f;
                weigh<kForm>(filter, gx, gy, weights + i * padded);
            }
            for (std::uint32_t i = 0; i < n; ++i) {
                const float* w = weights + i * padded;
                const std::size_t place = (records.y[first + i] >> 24) * row_pixels + (records.x[first + i] >> 24);
                add<kSide, kLanes>(w, records.values + std::size_t{first + i} * layout.lanes,
                                   unit_sum ? inverse_sum(w, count) : 1.0, side, layout.lanes, layout.split,
                                   window + place * layout.doubles(), row_pixels);
            }
            done += n;
        }
    }
}

void Splat(const FilterKernel& filter, const PixelSums& layout, bool unit_sum, const RecordColumns& records,
           std::span<const Segment> segments, double* window, std::size_t row_pixels) {
    using Form = FilterKernel::Form;
    const auto call = [&](auto* kernel) { kernel(filter, layout, unit_sum, records, segments, window, row_pixels); };
    const bool usual = filter.side() == 4 && layout.lanes == 4;
    switch (filter.form) {
        case Form::kQuartic:
            return usual ? call(splat_records<Form::kQuartic, 4, 4>) : call(splat_records<Form::kQuartic, 0, 0>);
        case Form::kTable:
            return usual ? call(splat_records<Form::kTable, 4, 4>) : call(splat_records<Form::kTable, 0, 0>);
        case Form::kSeparable:
            return call(splat_records<Form::kSeparable, 0, 0>);
        case Form::kBox:
            return call(splat_records<Form::kBox, 0, 0>);
    }
}

}  // namespace latent::develop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <fmt/format.h>

#include <utility>

namespace latent::develop {

HWY_EXPORT(Splat);

void splat(const FilterKernel& filter, const PixelSums& layout, bool unit_sum, const RecordColumns& records,
           std::span<const Segment> segments, double* window, std::size_t row_pixels) {
    HWY_DYNAMIC_DISPATCH(Splat)(filter, layout, unit_sum, records, segments, window, row_pixels);
}

namespace {
constexpr std::pair<std::string_view, std::int64_t> kLevels[] = {
    {"sse4", HWY_SSE4}, {"avx2", HWY_AVX2}, {"avx512", HWY_AVX3}, {"neon", HWY_NEON}, {"scalar", HWY_SCALAR}};
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
    const std::vector<std::string_view> levels = simd_levels();
    if (level != "best") {
        const auto* found =
            std::find_if(std::begin(kLevels), std::end(kLevels), [&](const auto& entry) { return entry.first == level; });
        if (std::find(levels.begin(), levels.end(), level) == levels.end()) {
            return Error{ErrorCode::kUsage, fmt::format("--simd {}: this processor has best, {}", level, fmt::join(levels, ", "))};
        }
        hwy::SetSupportedTargetsForTest(found->second);
    }
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return {};
}

}  // namespace latent::develop
#endif
