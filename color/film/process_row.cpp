#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "color/film/process_row.cpp"  // compiled once per instruction set by foreach_target.h
#include "color/film/process_row.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "color/power_vector-inl.h"

// Mul and Add only, no fused or approximate operation: all instruction sets give the same bits.
HWY_BEFORE_NAMESPACE();
namespace latent::film::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;
using I = hn::Rebind<std::int32_t, D>;
constexpr D d;
constexpr I integer;

using color::HWY_NAMESPACE::constant;

HWY_INLINE V log10_of(V x) {
    constexpr float kLog10Of2 = 0.30102999566F;
    return hn::Mul(color::HWY_NAMESPACE::log2(x), constant(kLog10Of2));
}

HWY_INLINE V power_of_ten(V v) {
    constexpr float kLog2Of10 = 3.32192809489F;
    return color::HWY_NAMESPACE::exp2(hn::Min(hn::Max(hn::Mul(v, constant(kLog2Of10)), constant(-100)), constant(100)));
}

using Places = decltype(hn::Zero(integer));

// Where x lies between entries: the one below, and the part of the way to the next.
struct Place {
    Places below;
    V part;
};
HWY_INLINE Place place_of(V x, float first, float per_unit, std::int32_t entries) {
    const V t = hn::Mul(hn::Sub(x, constant(first)), constant(per_unit));
    const V inside = hn::Min(hn::Max(t, constant(0)), constant(static_cast<float>(entries - 1)));
    const auto below = hn::Min(hn::ConvertTo(integer, inside), hn::Set(integer, entries - 2));
    return {below, hn::Sub(inside, hn::ConvertTo(d, below))};
}
HWY_INLINE V mix(V a, V b, V part) { return hn::Add(a, hn::Mul(part, hn::Sub(b, a))); }
HWY_INLINE V value_at(const Table1& table, const Place& place) {
    return mix(hn::GatherIndex(d, table.y.data(), place.below), hn::GatherIndex(d, table.y.data() + 1, place.below), place.part);
}
HWY_INLINE Place place_in(const Table1& table, V x) {
    return place_of(x, table.first, table.per_unit, static_cast<std::int32_t>(table.y.size()));
}
HWY_INLINE V value_of(const Table1& table, V x) { return value_at(table, place_in(table, x)); }

struct V3 {
    V a, b, c;
};

HWY_INLINE V3 value_of(const Table3& table, const V3& x) {
    constexpr std::int32_t kN = Table3::kNodes;
    const Place i = place_of(x.a, table.first[0], table.per_unit[0], kN), j = place_of(x.b, table.first[1], table.per_unit[1], kN),
                k = place_of(x.c, table.first[2], table.per_unit[2], kN);
    const auto n = hn::Set(integer, kN);
    const auto corner = hn::Mul(hn::Add(hn::Mul(hn::Add(hn::Mul(i.below, n), j.below), n), k.below), hn::Set(integer, 3));
    const float* v = table.v.data();
    const auto of = [&](int component) {
        const auto line = [&](int di, int dj) {
            const float* from = v + 3 * ((di * kN + dj) * kN) + component;
            return mix(hn::GatherIndex(d, from, corner), hn::GatherIndex(d, from + 3, corner), k.part);
        };
        return mix(mix(line(0, 0), line(0, 1), j.part), mix(line(1, 0), line(1, 1), j.part), i.part);
    };
    return {of(0), of(1), of(2)};
}

// What dye forming in the other layers takes of the log exposures.
HWY_INLINE V3 coupled(const ProcessTables& t, const V3& h) {
    // The three curves have the same places.
    const Place r = place_in(t.film[0], h.a), g = place_in(t.film[0], h.b), b = place_in(t.film[0], h.c);
    const V own_r = value_at(t.film[0], r), own_g = value_at(t.film[1], g), own_b = value_at(t.film[2], b);
    const auto held = [&](float k, V own, const Table1& table, const Place& place) {
        return hn::Mul(constant(k), hn::Sub(own, value_at(table, place)));
    };
    const auto [rg, gb, rb] = t.coupling;
    return {hn::Sub(h.a, hn::Add(held(rg, own_g, t.film[1], r), held(rb, own_b, t.film[2], r))),
            hn::Sub(h.b, hn::Add(held(rg, own_r, t.film[0], g), held(gb, own_b, t.film[2], g))),
            hn::Sub(h.c, hn::Add(held(rb, own_r, t.film[0], b), held(gb, own_g, t.film[1], b)))};
}

HWY_INLINE V log_exposure(V x, float scale) {
    const V scaled = hn::Mul(x, constant(scale)), least = constant(1e-12F), most = constant(1e12F);
    return log10_of(hn::IfThenElse(hn::Gt(scaled, least), hn::Min(scaled, most), least));  // NaN too
}

HWY_INLINE V grainy(V amount, const GrainRow* grain, std::size_t layer, std::size_t at) {
    if (grain == nullptr) return amount;
    return hn::Add(amount, hn::Mul(value_of((*grain->sigma)[layer], amount), hn::LoadU(d, grain->noise[layer] + at)));
}

HWY_INLINE V3 in_colour(const ProcessTables& t, V3 h, const GrainRow* grain, std::size_t at) {
    if (t.coupling[0] != 0 || t.coupling[2] != 0) h = coupled(t, h);
    V3 v{grainy(value_of(t.film[0], hn::Add(h.a, constant(t.shift[0]))), grain, 0, at),
         grainy(value_of(t.film[1], hn::Add(h.b, constant(t.shift[1]))), grain, 1, at),
         grainy(value_of(t.film[2], hn::Add(h.c, constant(t.shift[2]))), grain, 2, at)};
    v = value_of(t.through, v);
    const auto moved = [&](V x, std::size_t c) { return hn::Add(hn::Mul(x, constant(t.slope[c])), constant(t.offset[c])); };
    v = {moved(v.a, 0), moved(v.b, 1), moved(v.c, 2)};
    if (!t.print[0].y.empty()) {
        v = {value_of(t.print[0], v.a), value_of(t.print[1], v.b), value_of(t.print[2], v.c)};
        v = value_of(t.look, v);
    }
    return {power_of_ten(v.a), power_of_ten(v.b), power_of_ten(v.c)};
}

HWY_INLINE V3 in_black_and_white(const ProcessTables& t, V h, const GrainRow* grain, std::size_t at) {
    const V density = grainy(value_of(t.film[0], h), grain, 0, at);
    V v = hn::Add(hn::Mul(density, constant(t.slope[0])), constant(t.offset[0]));
    if (!t.print[0].y.empty()) v = value_of(t.print[0], v);
    const V light = power_of_ten(v);
    return {light, light, light};
}

void process_row_of_target(const ProcessTables& t, float scale, const std::array<const float*, 3>& in,
                           const std::array<float*, 3>& out, std::size_t count, const GrainRow* grain) {
    const std::size_t lanes = hn::Lanes(d);
    const auto process = [&](const std::array<const float*, 3>& from, const std::array<float*, 3>& to, std::size_t at,
                             const GrainRow* row_grain) {
        const auto exposure = [&](std::size_t c) { return log_exposure(hn::LoadU(d, from[c] + at), scale); };
        const V3 v = t.mono ? in_black_and_white(t, exposure(0), row_grain, at)
                            : in_colour(t, {exposure(0), exposure(1), exposure(2)}, row_grain, at);
        for (std::size_t c = 0; c < 3; ++c) {
            const float* m = &t.matrix[3 * c];
            const V sum =
                hn::Add(hn::Add(hn::Mul(constant(m[0]), v.a), hn::Mul(constant(m[1]), v.b)), hn::Mul(constant(m[2]), v.c));
            hn::StoreU(sum, d, to[c] + at);
        }
    };
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) process(in, out, i, grain);
    if (i == count) return;
    using Rest = std::array<float, HWY_MAX_BYTES / sizeof(float)>;
    std::array<Rest, 3> rest{}, noise{};
    for (std::size_t c = 0; c < 3; ++c) {
        std::copy(in[c] + i, in[c] + count, rest[c].begin());
        if (grain != nullptr) std::copy(grain->noise[c] + i, grain->noise[c] + count, noise[c].begin());
    }
    GrainRow rest_grain;
    if (grain != nullptr) rest_grain = {{noise[0].data(), noise[1].data(), noise[2].data()}, grain->sigma};
    process({rest[0].data(), rest[1].data(), rest[2].data()}, {rest[0].data(), rest[1].data(), rest[2].data()}, 0,
            grain != nullptr ? &rest_grain : nullptr);
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
