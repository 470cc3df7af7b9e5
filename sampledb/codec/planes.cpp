#include "sampledb/codec/planes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>

#include "hwy/highway.h"

namespace latent::sampledb {

namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::CappedTag<std::uint8_t, 16>;

const std::uint8_t* u8(const std::byte* p) { return reinterpret_cast<const std::uint8_t*>(p); }
std::uint8_t* u8(std::byte* p) { return reinterpret_cast<std::uint8_t*>(p); }

// For each set of four rows, as bytes of a vector: which value goes where if those in the set stand in front (compress), and if the
// next ones go to the rows of the set (expand); 0x80 makes a zero.
struct Moves {
    std::array<std::array<std::uint8_t, 16>, 16> together{}, apart{};
};
constexpr Moves kMoves = [] {
    Moves moves;
    for (unsigned set = 0; set < 16; ++set) {
        moves.together[set].fill(0x80);
        moves.apart[set].fill(0x80);
        unsigned next = 0;
        for (unsigned row = 0; row < 4; ++row) {
            if ((set >> row & 1) == 0) continue;
            for (unsigned byte = 0; byte < 4; ++byte) {
                moves.together[set][4 * next + byte] = static_cast<std::uint8_t>(4 * row + byte);
                moves.apart[set][4 * row + byte] = static_cast<std::uint8_t>(4 * next + byte);
            }
            ++next;
        }
    }
    return moves;
}();

const hn::FixedTag<std::uint8_t, 16> kFourBytes;  // values of four bytes

// The bit of row i and, above it, those of the next three, as far as they are in one byte.
unsigned set_of(ByteSpan bitmap, std::size_t i) { return std::to_integer<unsigned>(bitmap[i / 8]) >> (i % 8) & 15; }

}  // namespace

void split_planes(ByteSpan values, std::size_t value_width, std::span<std::byte> planes) {
    const std::size_t n = values.size() / value_width;
    std::size_t i = 0;
    if (value_width == 4) {
        const Lanes d;
        std::uint8_t* const to = u8(planes.data());
        for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) {
            hn::Vec<Lanes> b0, b1, b2, b3;
            hn::LoadInterleaved4(d, u8(values.data()) + 4 * i, b0, b1, b2, b3);
            hn::StoreU(b0, d, to + i);
            hn::StoreU(b1, d, to + n + i);
            hn::StoreU(b2, d, to + 2 * n + i);
            hn::StoreU(b3, d, to + 3 * n + i);
        }
    }
    for (; i < n; ++i) {
        for (std::size_t p = 0; p < value_width; ++p) planes[p * n + i] = values[i * value_width + p];
    }
}

namespace {

// Values of four bytes from the front on, sixteen at a time; returns how many.
std::size_t join_four(std::span<const ByteSpan> planes, std::span<std::byte> values) {
    const hn::FixedTag<std::uint8_t, 16> d;
    const hn::FixedTag<std::uint16_t, 8> d16;
    const std::size_t n = values.size() / 4;
    if (n < 16) return 0;
    std::array<std::array<std::uint8_t, 16>, 4> repeated;
    std::array<const std::uint8_t*, 4> from;
    std::array<std::size_t, 4> step;
    for (std::size_t p = 0; p < 4; ++p) {
        const bool constant = planes[p].size() == 1;
        repeated[p].fill(std::to_integer<std::uint8_t>(planes[p][0]));
        from[p] = constant ? repeated[p].data() : u8(planes[p].data());
        step[p] = constant ? 0 : 16;
    }
    const auto plane = [&](std::size_t p) {
        const auto bytes = hn::LoadU(d, from[p]);
        from[p] += step[p];
        return bytes;
    };
    std::uint8_t* to = u8(values.data());
    std::size_t i = 0;
    if (step[2] == 0 && step[3] == 0) {  // as in rounded values and differences
        const auto high = hn::Set(d16, static_cast<std::uint16_t>(repeated[3][0] << 8 | repeated[2][0]));
        for (; i + 16 <= n; i += 16, to += 64) {
            const auto b0 = plane(0), b1 = plane(1);
            const auto first = hn::BitCast(d16, hn::InterleaveLower(d, b0, b1)),
                       last = hn::BitCast(d16, hn::InterleaveUpper(d, b0, b1));
            hn::StoreU(hn::BitCast(d, hn::InterleaveLower(d16, first, high)), d, to);
            hn::StoreU(hn::BitCast(d, hn::InterleaveUpper(d16, first, high)), d, to + 16);
            hn::StoreU(hn::BitCast(d, hn::InterleaveLower(d16, last, high)), d, to + 32);
            hn::StoreU(hn::BitCast(d, hn::InterleaveUpper(d16, last, high)), d, to + 48);
        }
    }
    for (; i + 16 <= n; i += 16, to += 64) hn::StoreInterleaved4(plane(0), plane(1), plane(2), plane(3), d, to);
    return i;
}

}  // namespace

void join_planes(std::span<const ByteSpan> planes, std::span<std::byte> values) {
    const std::size_t value_width = planes.size();
    const std::size_t n = values.size() / value_width;
    if (value_width == 1 && planes[0].size() == n) {
        std::copy_n(planes[0].data(), n, values.data());
        return;
    }
    for (std::size_t i = value_width == 4 ? join_four(planes, values) : 0; i < n; ++i) {
        for (std::size_t p = 0; p < value_width; ++p) values[i * value_width + p] = planes[p][planes[p].size() == 1 ? 0 : i];
    }
}

std::size_t packed_size(std::size_t count, unsigned bits) { return (count * bits + 7) / 8; }

void pack_bits(std::span<const std::uint64_t> values, unsigned bits, Bytes& out) {
    const std::size_t begin = out.size();
    out.resize(begin + packed_size(values.size(), bits) + 8);  // whole words are written, then cut
    std::byte* to = out.data() + begin;
    std::uint64_t word = 0;
    unsigned filled = 0;
    for (const std::uint64_t value : values) {
        word |= value << filled;
        filled += bits;
        if (filled < 64) continue;
        store_le(to, word);
        to += 8;
        filled -= 64;
        word = filled == 0 ? 0 : value >> (bits - filled);
    }
    store_le(to, word);
    out.resize(begin + packed_size(values.size(), bits));
}

void unpack_bits(ByteSpan packed, unsigned bits, std::span<std::uint64_t> values) {
    assert(packed.size() >= packed_size(values.size(), bits));
    const std::uint64_t mask = bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
    const auto value_at = [&](const std::byte* from, std::size_t at) {
        const unsigned shift = at & 7;
        std::uint64_t value = load_le<std::uint64_t>(from + at / 8) >> shift;
        if (shift + bits > 64) value |= static_cast<std::uint64_t>(from[at / 8 + 8]) << (64 - shift);
        return value & mask;
    };
    std::size_t i = 0;
    if (bits == 16) {  // sample numbers of large runs
        for (; i < values.size(); ++i) values[i] = load_le<std::uint16_t>(&packed[2 * i]);
    }
    if (bits <= 56 && packed.size() >= 8) {  // a value is within the eight bytes from its first on
        const std::size_t safe = std::min(values.size(), bits == 0 ? values.size() : (packed.size() - 8) * 8 / bits + 1);
        for (std::size_t at = 0; i < safe; ++i, at += bits) values[i] = load_le<std::uint64_t>(&packed[at / 8]) >> (at & 7) & mask;
    }
    for (; i < values.size() && i * bits / 8 + 9 <= packed.size(); ++i) values[i] = value_at(packed.data(), i * bits);
    const std::size_t rest = i * bits / 8;  // the last few: from a copy that can be read past its end
    std::array<std::byte, 32> tail{};
    std::copy(packed.begin() + static_cast<std::ptrdiff_t>(std::min(rest, packed.size())), packed.end(), tail.begin());
    for (; i < values.size(); ++i) values[i] = value_at(tail.data(), i * bits - rest * 8);
}

std::size_t find_nonzero(ByteSpan values, Bytes& bitmap) {
    const hn::FixedTag<std::uint32_t, 4> d;
    const std::size_t n = values.size() / 4;
    bitmap.assign((n + 7) / 8, std::byte{0});
    std::size_t count = 0, i = 0;
    const auto add = [&](unsigned set) {
        bitmap[i / 8] |= static_cast<std::byte>(set << (i % 8));
        count += static_cast<std::size_t>(std::popcount(set));
    };
    for (; i + 4 <= n; i += 4) {
        const auto four = hn::BitCast(d, hn::LoadU(kFourBytes, u8(&values[4 * i])));
        std::array<std::uint8_t, 8> bits;
        hn::StoreMaskBits(d, hn::Ne(four, hn::Zero(d)), bits.data());
        add(bits[0]);
    }
    for (; i < n; ++i) add(load_le<std::uint32_t>(&values[4 * i]) != 0);
    return count;
}

void compress(ByteSpan bitmap, std::span<std::uint32_t> values) {
    auto* const bytes = reinterpret_cast<std::uint8_t*>(values.data());
    std::size_t count = 0, i = 0;
    for (; i + 4 <= values.size(); i += 4) {
        const unsigned set = set_of(bitmap, i);
        const auto four =
            hn::TableLookupBytesOr0(hn::LoadU(kFourBytes, bytes + 4 * i), hn::LoadU(kFourBytes, kMoves.together[set].data()));
        hn::StoreU(four, kFourBytes, bytes + 4 * count);
        count += static_cast<std::size_t>(std::popcount(set));
    }
    for (; i < values.size(); ++i) {
        values[count] = values[i];
        count += set_of(bitmap, i) & 1;
    }
}

void expand(ByteSpan bitmap, const std::uint32_t* nonzero, std::span<std::byte> values) {
    const std::size_t n = values.size() / 4;
    std::size_t i = 0;
    for (; i + 4 <= n; i += 4) {
        const unsigned set = set_of(bitmap, i);
        const auto next = hn::LoadU(kFourBytes, reinterpret_cast<const std::uint8_t*>(nonzero));
        hn::StoreU(hn::TableLookupBytesOr0(next, hn::LoadU(kFourBytes, kMoves.apart[set].data())), kFourBytes, u8(&values[4 * i]));
        nonzero += std::popcount(set);
    }
    for (; i < n; ++i) {
        const bool taken = (set_of(bitmap, i) & 1) != 0;
        store_le(&values[4 * i], taken ? *nonzero : 0);
        nonzero += taken;
    }
}

}  // namespace latent::sampledb
