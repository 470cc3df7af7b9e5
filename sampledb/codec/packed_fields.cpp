#include "sampledb/codec/packed_fields.h"

#include <cassert>
#include <cstring>
#include <utility>

#include "sampledb/codec/four_by_four.h"

namespace latent::sampledb {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kPlaces = kFieldsPerBlock / 4;  // where a field may lie in its lane
constexpr unsigned kWordBits = 32;                    // bits of a lane

// Field `place` of each lane of `words`, four words of four bytes each.
template <unsigned bits, std::size_t place>
void unpack_four(const std::byte* words, std::uint32_t* fields) {
    const four::Tag tag;
    constexpr std::size_t word = place * bits / kWordBits;
    constexpr unsigned shift = place * bits % kWordBits;
    Four four = hn::ShiftRight<static_cast<int>(shift)>(load(words + 16 * word));
    if constexpr (shift + bits > kWordBits)
        four = hn::Or(four, hn::ShiftLeft<static_cast<int>(kWordBits - shift)>(load(words + 16 * (word + 1))));
    if constexpr (shift + bits != kWordBits) four = hn::And(four, hn::Set(tag, (std::uint32_t{1} << bits) - 1));
    store(four, fields + 4 * place);
}

template <unsigned bits>
void unpack_block(const std::byte* words, std::uint32_t* fields) {
    if constexpr (bits == 0) {
        std::memset(fields, 0, sizeof(FieldBlock));
    } else {
        [&]<std::size_t... place>(std::index_sequence<place...>) { (unpack_four<bits, place>(words, fields), ...); }
        (std::make_index_sequence<kPlaces>());
    }
}

using Unpack = void (*)(const std::byte*, std::uint32_t*);
constexpr auto kUnpack = []<std::size_t... bits>(std::index_sequence<bits...>) {
    return std::array<Unpack, sizeof...(bits)>{&unpack_block<static_cast<unsigned>(bits)>...};
}
(std::make_index_sequence<kMaxFieldBits + 1>());

}  // namespace

void pack_fields(const FieldBlock& fields, std::size_t n, unsigned bits, std::byte* to) {
    assert(bits <= kMaxFieldBits);
    const four::Tag tag;
    Four words = hn::Zero(tag);
    unsigned filled = 0;
    for (std::size_t place = 0; 4 * place < n; ++place) {
        const Four four = load(&fields[4 * place]);
        words = hn::Or(words, hn::ShiftLeftSame(four, static_cast<int>(filled)));
        filled += bits;
        if (filled < kWordBits) continue;
        store(words, to);
        to += 16;
        filled -= kWordBits;
        words = filled == 0 ? hn::Zero(tag) : hn::ShiftRightSame(four, static_cast<int>(bits - filled));
    }
    if (filled > 0) store(words, to);
}

void unpack_fields(const std::byte* from, std::size_t n, unsigned bits, FieldBlock& fields) {
    assert(bits <= kMaxFieldBits);
    std::array<std::byte, packed_fields_size(kFieldsPerBlock, kMaxFieldBits)> padded;
    if (n < kFieldsPerBlock && bits > 0) {  // whole blocks are unpacked
        const std::size_t size = packed_fields_size(n, bits);
        std::memcpy(padded.data(), from, size);
        std::memset(padded.data() + size, 0, padded.size() - size);
        from = padded.data();
    }
    kUnpack[bits](from, fields.data());
}

}  // namespace latent::sampledb
