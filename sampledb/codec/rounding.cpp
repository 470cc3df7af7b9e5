#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sampledb/codec/rounding.cpp"  // compiled once per instruction set by foreach_target.h
#include "sampledb/codec/rounding.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>

#include "base/hash.h"

// Integers only: all instruction sets give the same bits.
HWY_BEFORE_NAMESPACE();
namespace latent::sampledb::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::uint32_t kIndexStep = 0x9E3779B9u;  // 2^32 / golden ratio, odd

// The functions below, of as many numbers as a vector holds or of one: D is that vector's tag.
template <class D, class V = hn::Vec<D>>
V mix64(D d, V x) {  // the finalizer of SplitMix64 [SplitMix64]
    x = hn::Mul(hn::Xor(x, hn::ShiftRight<30>(x)), hn::Set(d, 0xBF58476D1CE4E5B9u));
    x = hn::Mul(hn::Xor(x, hn::ShiftRight<27>(x)), hn::Set(d, 0x94D049BB133111EBu));
    return hn::Xor(x, hn::ShiftRight<31>(x));
}

template <class D, class V = hn::Vec<D>>
V mix32(D d, V x) {  // its like for 32 bits [Wellons18]: lowbias32
    x = hn::Mul(hn::Xor(x, hn::ShiftRight<16>(x)), hn::Set(d, 0x7FEB352Du));
    x = hn::Mul(hn::Xor(x, hn::ShiftRight<15>(x)), hn::Set(d, 0x846CA68Bu));
    return hn::Xor(x, hn::ShiftRight<16>(x));
}

template <class D, class V = hn::Vec<D>>
V seeds_of(D d, std::uint64_t key, V sample, V position) {
    return mix64(d, hn::Add(hn::Set(d, key), hn::Add(hn::Mul(sample, hn::Set(d, 0x9E3779B97F4A7C15u)),
                                                     hn::Mul(position, hn::Set(d, 0xD1B54A32D192ED03u)))));
}

template <class D, class V = hn::Vec<D>>
V rounded(D d, V bits, unsigned dropped, V random) {
    const V low = hn::Set(d, (std::uint32_t{1} << dropped) - 1);
    const V next = hn::AndNot(low, hn::Add(bits, hn::And(random, low)));
    const V magnitude = hn::And(bits, hn::Set(d, 0x7FFFFFFFu));
    const V highest = hn::Sub(hn::Set(d, 0x7F800000u - 1), low);  // that has a neighbour above
    return hn::IfThenElse(hn::Gt(magnitude, highest), bits, next);
}

// Calls f(tag, i) for i = 0 .. n-1, a vector at a time, then one number at a time.
template <class T, class F>
void for_each_vector(std::size_t n, const F& f) {
    const hn::ScalableTag<T> d;
    std::size_t i = 0;
    for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) f(d, i);
    for (; i < n; ++i) f(hn::CappedTag<T, 1>(), i);
}

void make_seeds(std::uint64_t key, const Page& page, std::size_t first, std::size_t n, std::uint32_t* low, std::uint32_t* high) {
    for_each_vector<std::uint64_t>(n, [&](auto d, std::size_t i) HWY_ATTR {
        const hn::Rebind<std::uint32_t, decltype(d)> d32;
        const auto u = hn::PromoteTo(d, hn::LoadU(d32, &page.u[first + i])),
                   v = hn::PromoteTo(d, hn::LoadU(d32, &page.v[first + i]));
        const auto seeds = seeds_of(d, key, hn::LoadU(d, &page.sample[first + i]), hn::Or(hn::ShiftLeft<32>(v), u));
        hn::StoreU(hn::TruncateTo(d32, seeds), d32, low + i);
        hn::StoreU(hn::TruncateTo(d32, hn::ShiftRight<32>(seeds)), d32, high + i);
    });
}

// Value i gets the random number of `low[i]` and `high[i]`, the halves of its record's seed.
void round_column(float* values, std::size_t n, std::uint32_t index, unsigned dropped, const std::uint32_t* low,
                  const std::uint32_t* high) {
    for_each_vector<std::uint32_t>(n, [&](auto d, std::size_t i) HWY_ATTR {
        const hn::Rebind<float, decltype(d)> df;
        const auto random =
            hn::Xor(mix32(d, hn::Add(hn::LoadU(d, low + i), hn::Set(d, index * kIndexStep))), hn::LoadU(d, high + i));
        hn::StoreU(hn::BitCast(df, rounded(d, hn::BitCast(d, hn::LoadU(df, values + i)), dropped, random)), df, values + i);
    });
}

// The powers of a record.
void round_pairs(float* power, std::size_t n, unsigned dropped, std::uint64_t seed) {
    const auto low = static_cast<std::uint32_t>(seed), high = static_cast<std::uint32_t>(seed >> 32);
    for_each_vector<std::uint32_t>(n, [&](auto d, std::size_t i) HWY_ATTR {
        const hn::Rebind<float, decltype(d)> df;
        const auto index = hn::Iota(d, static_cast<std::uint32_t>(i));
        const auto random = hn::Xor(mix32(d, hn::Add(hn::Mul(index, hn::Set(d, kIndexStep)), hn::Set(d, low))), hn::Set(d, high));
        hn::StoreU(hn::BitCast(df, rounded(d, hn::BitCast(d, hn::LoadU(df, power + i)), dropped, random)), df, power + i);
    });
}

std::uint64_t seed_of(std::uint64_t key, std::uint64_t sample, std::uint32_t u, std::uint32_t v) {
    const hn::CappedTag<std::uint64_t, 1> d;
    return hn::GetLane(seeds_of(d, key, hn::Set(d, sample), hn::Set(d, std::uint64_t{v} << 32 | u)));
}

std::uint32_t random_of(std::uint64_t seed, std::uint32_t index) {
    const hn::CappedTag<std::uint32_t, 1> d;
    return hn::GetLane(mix32(d, hn::Set(d, static_cast<std::uint32_t>(seed) + index * kIndexStep))) ^
           static_cast<std::uint32_t>(seed >> 32);
}

constexpr std::size_t kBlock = 512;  // records whose seeds are made at once

void round_page(std::uint64_t key, RecordKind kind, unsigned dropped, Page& page) {
    std::array<std::uint32_t, kBlock> low, high;
    float* power = page.power.data();
    for (std::size_t first = 0; first < page.count; first += kBlock) {
        const std::size_t n = std::min(kBlock, page.count - first);
        make_seeds(key, page, first, n, low.data(), high.data());
        if (kind == RecordKind::kXyz) {
            std::uint32_t index = 0;
            for (std::vector<float>* const column : {&page.x, &page.y, &page.z})
                round_column(column->data() + first, n, index++, dropped, low.data(), high.data());
        } else {
            for (std::size_t i = 0; i < n; power += page.pairs[first + i], ++i)
                round_pairs(power, page.pairs[first + i], dropped, std::uint64_t{high[i]} << 32 | low[i]);
        }
    }
}

}  // namespace
}  // namespace latent::sampledb::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "base/simd_dispatch.h"

namespace latent::sampledb {

namespace {
LATENT_SIMD_EXPORT(round_page);
}

std::uint64_t rounding_key(const JobId& job) {
    std::array<std::byte, 16> bytes;
    store_le(&bytes[0], job.low);
    store_le(&bytes[8], job.high);
    return hash64(bytes);
}

std::uint64_t rounding_seed(std::uint64_t key, std::uint64_t sample, std::uint32_t u, std::uint32_t v) {
    return HWY_STATIC_DISPATCH(seed_of)(key, sample, u, v);
}

std::uint32_t rounding_random(std::uint64_t seed, std::uint32_t index) { return HWY_STATIC_DISPATCH(random_of)(seed, index); }

void round_values(const Job& job, Page& page) {
    if (job.precision >= kFullPrecision) return;
    LATENT_SIMD_CALL(round_page)(rounding_key(job.id), job.kind, kFullPrecision - job.precision, page);
}

}  // namespace latent::sampledb
#endif  // HWY_ONCE
