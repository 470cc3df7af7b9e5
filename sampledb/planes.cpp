#include "sampledb/planes.h"

#include <fmt/format.h>
#define ZSTD_STATIC_LINKING_ONLY  // ZSTD_c_literalCompressionMode
#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <memory>

#include "hwy/highway.h"

namespace latent::sampledb {

namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::CappedTag<std::uint8_t, 16>;

constexpr std::size_t kMinCompressed = 64;  // below, a frame's own bytes eat the gain

const std::uint8_t* u8(const std::byte* p) { return reinterpret_cast<const std::uint8_t*>(p); }
std::uint8_t* u8(std::byte* p) { return reinterpret_cast<std::uint8_t*>(p); }

constexpr std::size_t kBlock = 64, kMostBlocks = 32;  // of the sample of a plane

// n log2(n) in units of 2^-8 bit, for the counts of a sample; integers, so that every machine writes the same file.
constexpr auto kSelfInformation = [] {
    std::array<std::uint32_t, kBlock * kMostBlocks + 1> table{};
    for (std::uint64_t n = 1; n < table.size(); ++n) {
        const int whole = std::bit_width(n) - 1;
        std::uint64_t x = n << (30 - whole), log = static_cast<std::uint64_t>(whole);  // 1 <= x / 2^30 < 2
        for (int bit = 0; bit < 16; ++bit) {
            x = x * x >> 30;
            log = log << 1 | x >> 31;
            x >>= x >> 31;
        }
        table[n] = static_cast<std::uint32_t>((n * log) >> 8);
    }
    return table;
}();

// Whether an entropy coder would save a sixteenth: less is worth neither the time to write nor that to read. Estimated from up to
// 32 blocks of 64 bytes, contiguous so that no stride of the data can hide in them: entropy of the sample, which is too small by
// (values that occur - 1) / (2 ln 2) bits [Miller55].
bool would_shrink(ByteSpan plane) {
    const std::size_t step = std::max(4 * kBlock, (plane.size() + kMostBlocks - 1) / kMostBlocks);
    std::array<std::array<std::uint16_t, 256>, 2> counts{};  // two, so that equal neighbours do not wait for each other
    std::size_t sampled = 0;
    for (std::size_t at = 0; at < plane.size(); at += step) {
        const ByteSpan block = plane.subspan(at, std::min(kBlock, plane.size() - at));
        for (std::size_t i = 0; i < block.size(); ++i) ++counts[i & 1][static_cast<std::uint8_t>(block[i])];
        sampled += block.size();
    }
    std::uint64_t information = 0, values = 0;
    for (std::size_t value = 0; value < 256; ++value) {
        const std::size_t count = counts[0][value] + counts[1][value];
        information += kSelfInformation[count];
        values += count > 0;
    }
    const std::uint64_t entropy = kSelfInformation[sampled] - information + (values - 1) * 256 * 721 / 1000;
    return entropy * 16 < 8 * 256 * sampled * 15;
}

// Level 1, but hasty about matches, which are few in planes like these: looked for at every fifth byte, and long enough not to be
// chance. Literals are coded in spite of that, as zstd's own faster levels do not.
struct Compressor {
    Compressor() {
        ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, 1);
        ZSTD_CCtx_setParameter(context.get(), ZSTD_c_minMatch, 6);
        ZSTD_CCtx_setParameter(context.get(), ZSTD_c_targetLength, 4);
        ZSTD_CCtx_setParameter(context.get(), ZSTD_c_literalCompressionMode, ZSTD_ps_enable);
    }
    std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context{ZSTD_createCCtx(), &ZSTD_freeCCtx};
    Bytes buffer;
};

}  // namespace

PlaneEntry encode_plane(ByteSpan plane, Bytes& out) {
    assert(!plane.empty());
    if (std::memcmp(plane.data(), plane.data() + 1, plane.size() - 1) == 0) {
        out.push_back(plane.front());
        return {PlaneCodec::kConstant, 1};
    }
    if (plane.size() >= kMinCompressed && would_shrink(plane)) {
        thread_local Compressor zstd;
        const std::size_t bound = ZSTD_compressBound(plane.size());
        if (zstd.buffer.size() < bound) zstd.buffer.resize(bound);
        const std::size_t size = ZSTD_compress2(zstd.context.get(), zstd.buffer.data(), bound, plane.data(), plane.size());
        if (!ZSTD_isError(size) && size < plane.size() - plane.size() / 64) {
            out.insert(out.end(), zstd.buffer.begin(), zstd.buffer.begin() + static_cast<std::ptrdiff_t>(size));
            return {PlaneCodec::kZstd, static_cast<std::uint32_t>(size)};
        }
    }
    out.insert(out.end(), plane.begin(), plane.end());
    return {PlaneCodec::kRaw, static_cast<std::uint32_t>(plane.size())};
}

Result<ByteSpan> decode_plane(PlaneEntry entry, ByteSpan stored, std::size_t size, Bytes& scratch) {
    const auto corrupt = [](const char* why) { return Error{ErrorCode::kCorrupt, why}; };
    if (entry.codec == PlaneCodec::kRaw) {
        if (stored.size() != size) return corrupt("a raw plane of another size");
        return stored;
    }
    if (scratch.size() < size) scratch.resize(size);
    const std::span<std::byte> plane = std::span(scratch).first(size);
    switch (entry.codec) {
        case PlaneCodec::kConstant:
            if (stored.size() != 1) return corrupt("a constant plane of several bytes");
            std::fill(plane.begin(), plane.end(), stored.front());
            return ByteSpan(plane);
        case PlaneCodec::kZstd: {
            thread_local const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context{ZSTD_createDCtx(), &ZSTD_freeDCtx};
            // exactly one frame, and no skippable one
            if (stored.size() < 4 || load_le<std::uint32_t>(stored.data()) != ZSTD_MAGICNUMBER ||
                ZSTD_findFrameCompressedSize(stored.data(), stored.size()) != stored.size() ||
                ZSTD_decompressDCtx(context.get(), plane.data(), size, stored.data(), stored.size()) != size) {
                return corrupt("a plane that zstd does not read");
            }
            return ByteSpan(plane);
        }
        default:
            return Error{ErrorCode::kUnsupported, fmt::format("plane codec {} is not known", static_cast<int>(entry.codec))};
    }
}

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

void join_planes(std::span<const ByteSpan> planes, std::span<std::byte> values) {
    const std::size_t value_width = planes.size();
    const std::size_t n = values.size() / value_width;
    std::size_t i = 0;
    if (value_width == 4) {
        const Lanes d;
        for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) {
            const auto plane = [&](std::size_t p) { return hn::LoadU(d, u8(planes[p].data()) + i); };
            hn::StoreInterleaved4(plane(0), plane(1), plane(2), plane(3), d, u8(values.data()) + 4 * i);
        }
    }
    for (; i < n; ++i) {
        for (std::size_t p = 0; p < value_width; ++p) values[i * value_width + p] = planes[p][i];
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
    for (; i < values.size() && i * bits / 8 + 9 <= packed.size(); ++i) values[i] = value_at(packed.data(), i * bits);
    const std::size_t rest = i * bits / 8;  // the last few: from a copy that can be read past its end
    std::array<std::byte, 32> tail{};
    std::copy(packed.begin() + static_cast<std::ptrdiff_t>(std::min(rest, packed.size())), packed.end(), tail.begin());
    for (; i < values.size(); ++i) values[i] = value_at(tail.data(), i * bits - rest * 8);
}

}  // namespace latent::sampledb
