#include "sampledb/planes.h"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <memory>

#include "hwy/highway.h"

namespace latent::sampledb {

namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::CappedTag<std::uint8_t, 16>;

constexpr int kZstdLevel = 1;
constexpr std::size_t kMinCompressed = 64;  // below, a frame's own bytes eat the gain

const std::uint8_t* u8(const std::byte* p) { return reinterpret_cast<const std::uint8_t*>(p); }
std::uint8_t* u8(std::byte* p) { return reinterpret_cast<std::uint8_t*>(p); }

// Whether an entropy coder could gain a percent: the chance that two bytes of a sample are equal is 1/256 for noise. The sample
// is every fourth block of 64 bytes, contiguous so that no stride of the data can hide in it.
bool looks_like_noise(ByteSpan plane) {
    constexpr std::size_t kSampled = 64, kStep = 256;
    std::array<std::uint32_t, 256> count{};
    std::uint64_t sampled = 0;
    for (std::size_t at = 0; at < plane.size(); at += kStep) {
        const ByteSpan block = plane.subspan(at, std::min(kSampled, plane.size() - at));
        for (const std::byte b : block) ++count[static_cast<std::uint8_t>(b)];
        sampled += block.size();
    }
    std::uint64_t equal_pairs = 0;
    for (const std::uint64_t c : count) equal_pairs += c * c;
    equal_pairs -= sampled;
    return sampled >= 512 && equal_pairs * 256 * 10 < sampled * (sampled - 1) * 11;
}

struct Compressor {
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
    if (plane.size() >= kMinCompressed && !looks_like_noise(plane)) {
        thread_local Compressor zstd;
        const std::size_t bound = ZSTD_compressBound(plane.size());
        if (zstd.buffer.size() < bound) zstd.buffer.resize(bound);
        const std::size_t size =
            ZSTD_compressCCtx(zstd.context.get(), zstd.buffer.data(), bound, plane.data(), plane.size(), kZstdLevel);
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
