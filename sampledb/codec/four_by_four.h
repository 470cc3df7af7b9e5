// sampledb/codec/four_by_four.h: vectors of four numbers of four bytes, and four of these with rows and columns exchanged.
#pragma once

#include <cstdint>

#include "hwy/highway.h"

namespace latent::sampledb {

namespace four {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::FixedTag<std::uint32_t, 4>;
using Pairs = hn::FixedTag<std::uint64_t, 2>;

}  // namespace four

using Four = four::hn::Vec<four::Tag>;

// 16 bytes from `from` on, or to `to`, wherever they are.
template <class T>
Four load(const T* from) {
    return four::hn::LoadU(four::Tag(), reinterpret_cast<const std::uint32_t*>(from));
}
template <class T>
void store(Four numbers, T* to) {
    four::hn::StoreU(numbers, four::Tag(), reinterpret_cast<std::uint32_t*>(to));
}

// Both lower halves, both upper halves.
inline Four lower(Four a, Four b) {
    const four::Pairs two;
    return four::hn::BitCast(four::Tag(), four::hn::InterleaveLower(two, four::hn::BitCast(two, a), four::hn::BitCast(two, b)));
}
inline Four upper(Four a, Four b) {
    const four::Pairs two;
    return four::hn::BitCast(four::Tag(), four::hn::InterleaveUpper(two, four::hn::BitCast(two, a), four::hn::BitCast(two, b)));
}

struct FourByFour {
    Four a, b, c, d;

    FourByFour transposed() const {
        const four::Tag tag;
        const Four ab_low = four::hn::InterleaveLower(tag, a, b), cd_low = four::hn::InterleaveLower(tag, c, d);
        const Four ab_high = four::hn::InterleaveUpper(tag, a, b), cd_high = four::hn::InterleaveUpper(tag, c, d);
        return {lower(ab_low, cd_low), upper(ab_low, cd_low), lower(ab_high, cd_high), upper(ab_high, cd_high)};
    }
};

}  // namespace latent::sampledb
