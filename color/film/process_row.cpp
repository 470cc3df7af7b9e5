#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "color/film/process_row.cpp"  // compiled once per instruction set by foreach_target.h
#include "color/film/process_row.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstdint>

#include "color/power_vector-inl.h"

// Logarithms and powers are of vectors of one layer. All between them is of vectors of whole pixels, four lanes each: what a table
// has for a pixel then lies side by side, and need not be gathered number by number. Mul and Add only, no fused or approximate
// operation: all instruction sets give the same bits.
HWY_BEFORE_NAMESPACE();
namespace latent::film::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;
constexpr D d;
constexpr hn::Rebind<std::int32_t, D> integer;
constexpr std::size_t kLanes = hn::MaxLanes(d);

using color::HWY_NAMESPACE::constant;

HWY_INLINE V log10_of(V x) {
    constexpr float kLog10Of2 = 0.30102999566F;
    return hn::Mul(color::HWY_NAMESPACE::log2(x), constant(kLog10Of2));
}

HWY_INLINE V power_of_ten(V v) {
    constexpr float kLog2Of10 = 3.32192809489F;
    return color::HWY_NAMESPACE::exp2(hn::Min(hn::Max(hn::Mul(v, constant(kLog2Of10)), constant(-100)), constant(100)));
}

HWY_INLINE V log_exposure(V x, float scale) {
    const V scaled = hn::Mul(x, constant(scale)), least = constant(1e-12F), most = constant(1e12F);
    return log10_of(hn::IfThenElse(hn::Gt(scaled, least), hn::Min(scaled, most), least));  // NaN too
}

// Where each layer lies between entries: `below` is the one below, and the part of the way to the next is returned.
template <class Table>
HWY_INLINE V place_in(const Table& table, V x, decltype(hn::Zero(integer))& below) {
    const V t = hn::Mul(hn::Sub(x, hn::LoadDup128(d, table.first.data())), hn::LoadDup128(d, table.per_unit.data()));
    const V inside = hn::Min(hn::Max(t, hn::Zero(d)), hn::LoadDup128(d, table.last.data()));
    below = hn::ConvertTo(integer, inside);
    return hn::Sub(inside, hn::ConvertTo(d, below));
}

// Four numbers for each pixel, from `table` + `at`[4 pixel] on.
template <class Tag>
HWY_INLINE hn::Vec<Tag> load(Tag tag, const float* table, const std::int32_t* at) {
    if constexpr (hn::MaxLanes(tag) == 4) {
        return hn::LoadU(tag, table + *at);
    } else {
        constexpr hn::Half<Tag> half;
        return hn::Combine(tag, load(half, table, at + hn::MaxLanes(half)), load(half, table, at));
    }
}

HWY_INLINE V value_of(const LayerTables& tables, V x) {
    auto below = hn::Zero(integer);
    const V part = place_in(tables, x, below);
    HWY_ALIGN std::array<std::int32_t, kLanes> at;
    hn::Store(hn::ShiftLeft<3>(below), integer, at.data());
    const auto of = [&](std::size_t layer, V way) {
        const float* table = tables.y[layer].data();
        return hn::Add(load(d, table, at.data() + layer), hn::Mul(way, load(d, table + 4, at.data() + layer)));
    };
    return hn::Add(hn::Add(of(0, hn::Broadcast<0>(part)), of(1, hn::Broadcast<1>(part))), of(2, hn::Broadcast<2>(part)));
}

HWY_INLINE V value_of(const Table3& table, V x) {
    constexpr std::int32_t kOne = 3, kLine = kOne * Table3::kNodes, kPlane = kLine * Table3::kNodes;
    auto below = hn::Zero(integer);
    const V part = place_in(table, x, below);
    constexpr std::array<std::int32_t, 4> kSteps{kPlane, kLine, kOne, 0};
    const auto steps = hn::Mul(below, hn::LoadDup128(integer, kSteps.data())), pairs = hn::Add(steps, hn::Shuffle2301(steps));
    HWY_ALIGN std::array<std::int32_t, kLanes> at;
    hn::Store(hn::Add(pairs, hn::Shuffle1032(pairs)), integer, at.data());
    const auto mix = [](V a, V b, V way) { return hn::Add(a, hn::Mul(way, hn::Sub(b, a))); };
    const V i = hn::Broadcast<0>(part), j = hn::Broadcast<1>(part), k = hn::Broadcast<2>(part);
    const float* v = table.v.data();
    const auto line = [&](const float* from) { return mix(load(d, from, at.data()), load(d, from + kOne, at.data()), k); };
    return mix(mix(line(v), line(v + kLine), j), mix(line(v + kPlane), line(v + kPlane + kLine), j), i);
}

constexpr std::size_t kAtOnce = 64;  // pixels
using Planes = std::array<const float*, 3>;

// Four numbers for each pixel.
struct Pixels {
    HWY_ALIGN std::array<float, 4 * kAtOnce> v;

    template <class Make>
    HWY_INLINE void fill(const Planes& planes, const Make& make) {
        for (std::size_t i = 0; i < kAtOnce; i += kLanes)
            hn::StoreInterleaved4(make(hn::LoadU(d, planes[0] + i)), make(hn::LoadU(d, planes[1] + i)),
                                  make(hn::LoadU(d, planes[2] + i)), hn::Zero(d), d, v.data() + 4 * i);
    }
    // `step`(some pixels, their place in `v`).
    template <class Step>
    HWY_INLINE void each(const Step& step) {
        for (std::size_t i = 0; i < v.size(); i += kLanes) hn::Store(step(hn::Load(d, v.data() + i), i), d, v.data() + i);
    }
};

// kAtOnce pixels.
void process(const ProcessTables& t, float scale, const Planes& in, const std::array<float*, 3>& out, const GrainRow* grain) {
    const auto planes = [&](const Planes& all) { return t.mono ? Planes{all[0], all[0], all[0]} : all; };
    Pixels pixels, noise;
    pixels.fill(planes(in), [&](V x) { return log_exposure(x, scale); });
    if (!t.coupling.empty()) pixels.each([&](V h, std::size_t) { return hn::Add(h, value_of(t.coupling, h)); });
    pixels.each([&](V h, std::size_t) { return value_of(t.film, h); });
    if (grain != nullptr) {
        noise.fill(planes(grain->noise), [](V n) { return n; });
        pixels.each([&](V amounts, std::size_t at) {
            return hn::Add(amounts, hn::Mul(value_of(*grain->sigma, amounts), hn::Load(d, noise.v.data() + at)));
        });
    }
    if (!t.through.empty()) pixels.each([&](V amounts, std::size_t) { return value_of(t.through, amounts); });
    const V slope = hn::LoadDup128(d, t.slope.data()), offset = hn::LoadDup128(d, t.offset.data());
    pixels.each([&](V x, std::size_t) { return hn::Add(hn::Mul(x, slope), offset); });
    if (!t.print.empty()) pixels.each([&](V h, std::size_t) { return value_of(t.print, h); });
    if (!t.look.empty()) pixels.each([&](V amounts, std::size_t) { return value_of(t.look, amounts); });
    for (std::size_t i = 0; i < kAtOnce; i += kLanes) {
        V a, b, c, unused;
        hn::LoadInterleaved4(d, pixels.v.data() + 4 * i, a, b, c, unused);
        a = power_of_ten(a), b = power_of_ten(b), c = power_of_ten(c);
        for (std::size_t k = 0; k < 3; ++k) {
            const float* m = &t.matrix[3 * k];
            hn::StoreU(hn::Add(hn::Add(hn::Mul(constant(m[0]), a), hn::Mul(constant(m[1]), b)), hn::Mul(constant(m[2]), c)), d,
                       out[k] + i);
        }
    }
}

void process_row_of_target(const ProcessTables& t, float scale, const Planes& in, const std::array<float*, 3>& out,
                           std::size_t count, const GrainRow* grain) {
    const auto from = [](const Planes& planes, std::size_t i) { return Planes{planes[0] + i, planes[1] + i, planes[2] + i}; };
    GrainRow here{};
    if (grain != nullptr) here.sigma = grain->sigma;
    std::size_t i = 0;
    for (; i + kAtOnce <= count; i += kAtOnce) {
        if (grain != nullptr) here.noise = from(grain->noise, i);
        process(t, scale, from(in, i), {out[0] + i, out[1] + i, out[2] + i}, grain != nullptr ? &here : nullptr);
    }
    if (i == count) return;
    std::array<std::array<float, kAtOnce>, 3> rest{}, noise{};
    for (std::size_t c = 0; c < 3; ++c) {
        std::copy(in[c] + i, in[c] + count, rest[c].begin());
        if (grain != nullptr) std::copy(grain->noise[c] + i, grain->noise[c] + count, noise[c].begin());
    }
    here.noise = {noise[0].data(), noise[1].data(), noise[2].data()};
    process(t, scale, {rest[0].data(), rest[1].data(), rest[2].data()}, {rest[0].data(), rest[1].data(), rest[2].data()},
            grain != nullptr ? &here : nullptr);
    for (std::size_t c = 0; c < 3; ++c) std::copy_n(rest[c].begin(), count - i, out[c] + i);
}

}  // namespace
}  // namespace latent::film::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/simd_dispatch.h"

namespace latent::film {

LATENT_SIMD_EXPORT(process_row_of_target);

void process_row(const ProcessTables& tables, float scale, const std::array<const float*, 3>& in, const std::array<float*, 3>& out,
                 std::size_t count, const GrainRow* grain) {
    LATENT_SIMD_CALL(process_row_of_target)(tables, scale, in, out, count, grain);
}

}  // namespace latent::film
#endif
