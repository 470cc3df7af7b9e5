// tools/develop/kernel/weights-inl.h: what the filter weighs in the pixels of a record's footprint; included once for each
// instruction set. Equations: docs/developing.md, "Filters".
#if defined(LATENT_DEVELOP_WEIGHTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATENT_DEVELOP_WEIGHTS_INL_H_
#undef LATENT_DEVELOP_WEIGHTS_INL_H_
#else
#define LATENT_DEVELOP_WEIGHTS_INL_H_
#endif

#include <hwy/highway.h>

#include "tools/develop/film/filter.h"

HWY_BEFORE_NAMESPACE();
namespace latent::develop::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Only Mul, Add, Sub, Min, Max and Sqrt, one after another as written (-ffp-contract=off): every instruction set rounds alike.
// Weights come in two steps, so that the square root of one record is under way while others go on: `begin_weight` and, of what it
// returns, `end_weight`.
template <class D>
HWY_INLINE hn::Vec<D> begin_quartic(D d, const FilterKernel& f, hn::Vec<D> dx, hn::Vec<D> dy) {
    const auto r2 = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
    return hn::Sqrt(hn::Min(hn::Mul(r2, hn::Set(d, f.inverse_radius2)), hn::Set(d, 1.0f)));
}
template <class D>
HWY_INLINE hn::Vec<D> end_quartic(D d, const FilterKernel& f, hn::Vec<D> rho) {
    const auto one = hn::Set(d, 1.0f);
    const auto rest = hn::Sub(one, rho);
    const auto inner = hn::Add(hn::Set(d, 2.0f), hn::Mul(rho, hn::Set(d, f.s)));
    const auto factor = hn::Max(hn::Add(one, hn::Mul(rho, inner)), hn::Set(d, f.min_factor));
    return hn::Mul(hn::Mul(rest, rest), factor);
}

template <class D>
HWY_INLINE hn::Vec<D> table(D d, const FilterKernel& f, hn::Vec<D> dx, hn::Vec<D> dy) {
    const hn::RebindToSigned<D> di;
    const auto r2 = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
    const auto t = hn::Min(hn::Mul(r2, hn::Set(d, f.table_scale)), hn::Set(d, static_cast<float>(FilterKernel::kTableSteps)));
    const auto i = hn::ConvertTo(di, t);
    const auto fraction = hn::Sub(t, hn::ConvertTo(d, i));
    return hn::Add(hn::GatherIndex(d, f.table_value.data(), i), hn::Mul(fraction, hn::GatherIndex(d, f.table_step.data(), i)));
}

template <class D>
HWY_INLINE hn::Vec<D> cubic(D d, const float (&c)[4], hn::Vec<D> x) {
    const auto upper = hn::Add(hn::Set(d, c[2]), hn::Mul(x, hn::Set(d, c[3])));
    return hn::Add(hn::Set(d, c[0]), hn::Mul(x, hn::Add(hn::Set(d, c[1]), hn::Mul(x, upper))));
}
template <class D>
HWY_INLINE hn::Vec<D> separable(D d, const FilterKernel& f, hn::Vec<D> dx, hn::Vec<D> dy) {
    const auto one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f);
    const auto m = [&](hn::Vec<D> distance) HWY_ATTR {
        const auto x = hn::Abs(distance);
        return hn::IfThenElse(hn::Lt(x, one), cubic(d, f.inner, x),
                              hn::IfThenElseZero(hn::Lt(x, two), cubic(d, f.outer, hn::Sub(two, x))));
    };
    return hn::Mul(m(dx), m(dy));
}

template <FilterKernel::Form kForm, class D>
HWY_INLINE hn::Vec<D> begin_weight(D d, const FilterKernel& f, hn::Vec<D> dx, hn::Vec<D> dy) {
    if constexpr (kForm == FilterKernel::Form::kQuartic) return begin_quartic(d, f, dx, dy);
    if constexpr (kForm == FilterKernel::Form::kTable) return table(d, f, dx, dy);
    if constexpr (kForm == FilterKernel::Form::kSeparable) return separable(d, f, dx, dy);
}
template <FilterKernel::Form kForm, class D>
HWY_INLINE hn::Vec<D> end_weight(D d, const FilterKernel& f, hn::Vec<D> begun) {
    if constexpr (kForm == FilterKernel::Form::kQuartic) return end_quartic(d, f, begun);
    return begun;
}

// The two steps for the first `count` pixels of the footprint of a record at (gx, gy), row after row; `count` is a multiple of what
// a vector holds. The weights are written as float64; negative ones become 0 if `kPositive`.
template <FilterKernel::Form kForm, class D>
HWY_INLINE void begin_weights(D d, const FilterKernel& f, std::size_t count, float gx, float gy, float* HWY_RESTRICT begun) {
    const auto x = hn::Set(d, gx), y = hn::Set(d, gy);
    for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
        const auto dx = hn::Sub(hn::LoadU(d, f.column.data() + k), x), dy = hn::Sub(hn::LoadU(d, f.row.data() + k), y);
        hn::StoreU(begin_weight<kForm>(d, f, dx, dy), d, begun + k);
    }
}
template <FilterKernel::Form kForm, bool kPositive, class D>
HWY_INLINE void end_weights(D d, const FilterKernel& f, std::size_t count, const float* HWY_RESTRICT begun,
                            double* HWY_RESTRICT weights) {
    const hn::CappedTag<double, hn::MaxLanes(d)> dd;
    const hn::Rebind<float, decltype(dd)> half;
    HWY_ALIGN float w[hn::MaxLanes(d)];
    for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
        auto v = end_weight<kForm>(d, f, hn::LoadU(d, begun + k));
        if constexpr (kPositive) v = hn::Max(v, hn::Zero(d));
        hn::Store(v, d, w);
        for (std::size_t i = 0; i < hn::Lanes(d); i += hn::Lanes(dd))
            hn::StoreU(hn::PromoteTo(dd, hn::LoadU(half, w + i)), dd, weights + k + i);
    }
}

}  // namespace latent::develop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
