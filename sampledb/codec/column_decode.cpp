#include "sampledb/codec/column_decode.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "sampledb/codec/delta2.h"
#include "sampledb/codec/planes.h"
#include "sampledb/codec/zigzag.h"
#include "sampledb/data/film_position.h"
#include "sampledb/data/unreadable.h"

namespace latent::sampledb {

namespace {

constexpr unsigned kMaxStep = 22;

Result<unsigned> step_of(const ColumnEntry& entry, bool stepped) {
    if (!stepped) return 0u;
    if (entry.bits < 1 || entry.bits > kMaxStep) return corrupt("a step of impossible size");
    return unsigned{entry.bits};
}

Status unknown_transform(const ColumnEntry& entry) {
    return Error{ErrorCode::kUnsupported,
                 fmt::format("column {}: unknown transform {}", static_cast<int>(entry.column), static_cast<int>(entry.transform))};
}

}  // namespace

Status ColumnDecoder::load_planes(const ColumnEntry& entry, std::size_t first, ByteSpan stored, std::span<std::byte> values,
                                  std::size_t value_width) {
    if (entry.planes.size() != first + value_width) return corrupt("a column without all of its planes");
    std::array<ByteSpan, kMaxPlanes> planes;
    for (std::size_t p = 0; p < value_width; ++p) {
        const PlaneEntry& plane = entry.planes[first + p];
        if (plane.codec == PlaneCodec::kConstant && plane.stored_size == 1) {
            planes[p] = stored.first(1);  // stands for all
            stored = stored.subspan(1);
            continue;
        }
        const Result<ByteSpan> bytes =
            planes_.decode(plane, stored.first(plane.stored_size), values.size() / value_width, plane_[p]);
        if (!bytes) return bytes.error();
        planes[p] = *bytes;
        stored = stored.subspan(plane.stored_size);
    }
    join_planes(std::span(planes).first(value_width), values);
    return {};
}

Status ColumnDecoder::packed(const ColumnEntry& entry, std::span<std::uint64_t> values) {
    if (entry.bits == 0) {
        std::ranges::fill(values, 0);
        return entry.planes.empty() ? Status{} : corrupt("a constant column with planes");
    }
    if (entry.planes.size() != 1) return corrupt("a packed column with several planes");
    const Result<ByteSpan> packed =
        planes_.decode(entry.planes[0], entry.stored, packed_size(values.size(), entry.bits), plane_[0]);
    if (!packed) return packed.error();
    unpack_bits(*packed, entry.bits, values);
    return {};
}

Status ColumnDecoder::plain(const ColumnEntry& entry, std::span<std::byte> values, std::size_t value_width) {
    if (values.empty()) return {};
    if (entry.transform == Transform::kPlanes) return load_planes(entry, 0, entry.stored, values, value_width);
    if (entry.transform != Transform::kPacked || entry.bits != 0 || !entry.planes.empty()) return unknown_transform(entry);
    for (std::size_t at = 0; at < values.size(); at += value_width) std::memcpy(&values[at], &entry.base, value_width);
    return {};
}

Status ColumnDecoder::samples(const ColumnEntry& entry, std::span<std::uint64_t> n) {
    if (entry.transform != Transform::kPacked && entry.transform != Transform::kLattice) return unknown_transform(entry);
    if (Status s = packed(entry, n); !s) return s;
    if (entry.transform == Transform::kPacked) {
        for (std::uint64_t& value : n) value += entry.base;
        return {};
    }
    const unsigned s = entry.lattice_bits;
    if (s == 0) return corrupt("a lattice without bits");
    const std::uint64_t mask = (std::uint64_t{1} << s) - 1;
    const std::uint64_t high = entry.base & ~mask;
    const std::uint32_t f0 = reverse_bits(static_cast<std::uint32_t>(entry.base & mask));  // in its s high bits
    for (std::uint64_t& value : n) value = high | reverse_bits(f0 + static_cast<std::uint32_t>(value << (32 - s)));
    return {};
}

Status ColumnDecoder::luminance(const ColumnEntry& entry, std::span<float> values, BrightRows& bright) {
    bright.known = entry.transform == Transform::kSparse;
    if (!bright.known) return plain(entry, std::as_writable_bytes(values), 4);
    if (entry.planes.empty()) return corrupt("a column without all of its planes");
    const PlaneEntry& plane = entry.planes[0];
    const Result<ByteSpan> bitmap =
        planes_.decode(plane, entry.stored.first(plane.stored_size), (values.size() + 7) / 8, plane_[0]);
    if (!bitmap) return bitmap.error();
    bright.bitmap.assign(bitmap->begin(), bitmap->end());
    bright.count = 0;
    for (const std::byte rows : bright.bitmap)
        bright.count += static_cast<std::size_t>(std::popcount(std::to_integer<unsigned>(rows)));
    if (bright.count == 0 || std::to_integer<unsigned>(bright.bitmap.back()) >> ((values.size() - 1) % 8 + 1) != 0) {
        return corrupt("a bitmap with no row set, or with one beyond the last");
    }
    const std::span<std::uint32_t> y = at_least(bright.y, bright.count + kExpandPadding).first(bright.count);
    if (Status s = load_planes(entry, 1, entry.stored.subspan(plane.stored_size), std::as_writable_bytes(y), 4); !s) return s;
    expand(bright.bitmap, y.data(), std::as_writable_bytes(values));
    return {};
}

Status ColumnDecoder::crossed(const ColumnEntry& entry, std::span<float> values, std::span<const float> y,
                              const BrightRows& bright) {
    const std::span<std::byte> bytes = std::as_writable_bytes(values);
    const bool sparse = entry.transform == Transform::kSparseCross || entry.transform == Transform::kSteppedSparseCross;
    const bool stepped = entry.transform == Transform::kSteppedCross || entry.transform == Transform::kSteppedSparseCross;
    if (entry.transform != Transform::kCross && !sparse && !stepped) return plain(entry, bytes, 4);
    const Result<unsigned> step = step_of(entry, stepped);
    if (!step) return step.error();
    if (sparse && !bright.known) return corrupt("a sparse x or z beside a y that is not sparse");
    const std::size_t count = sparse ? bright.count : values.size();
    const std::span<std::uint32_t> words = at_least(words_, count + kExpandPadding).first(count);
    if (Status s = load_planes(entry, 0, entry.stored, std::as_writable_bytes(words), 4); !s) return s;
    if (sparse) {
        for (std::size_t i = 0; i < count; ++i) words[i] = bright.y[i] + unzigzag(words[i], *step);
        expand(bright.bitmap, words.data(), bytes);
    } else {
        for (std::size_t i = 0; i < count; ++i) {
            values[i] = std::bit_cast<float>(std::bit_cast<std::uint32_t>(y[i]) + unzigzag(words[i], *step));
        }
    }
    return {};
}

// The first three say how long the others are.
Result<ColumnDecoder::PackedPlanes> ColumnDecoder::packed_planes(const ColumnEntry& entry, const Delta2Blocks& blocks) {
    if (entry.planes.size() != kDelta2Planes) return corrupt("a column without all of its planes");
    std::array<std::size_t, kDelta2Planes> sizes{(blocks.k() + 1) * sizeof(std::uint32_t), blocks.count(), blocks.count()};
    PackedPlanes planes;
    ByteSpan stored = entry.stored;
    for (std::size_t p = 0; p < kDelta2Planes; ++p) {
        if (p == kFields) {
            const auto more = Delta2Unpacker::sizes(blocks, planes[kWidths], planes[kCounts]);
            if (!more) return more.error();
            sizes[kFields] = more->fields;
            sizes[kPositions] = sizes[kExtraLow] = sizes[kExtraHigh] = more->exceptions;
        }
        const PlaneEntry& plane = entry.planes[p];
        const Result<ByteSpan> bytes = planes_.decode(plane, stored.first(plane.stored_size), sizes[p], plane_[p]);
        if (!bytes) return bytes.error();
        planes[p] = *bytes;
        stored = stored.subspan(plane.stored_size);
    }
    return planes;
}

Status ColumnDecoder::along_records(const ColumnEntry& entry, std::span<float> values, std::span<const std::uint16_t> pairs,
                                    std::size_t k) {
    const std::span<std::byte> bytes = std::as_writable_bytes(values);
    const bool packed = entry.transform == Transform::kPackedDelta2;
    const bool stepped = entry.transform == Transform::kSteppedDelta2 || packed;
    if (entry.transform != Transform::kDelta2 && !stepped) return plain(entry, bytes, 4);
    const Result<unsigned> step = step_of(entry, stepped);
    if (!step) return step.error();
    if (packed) {
        const Delta2Blocks blocks(pairs, k);
        const Result<PackedPlanes> planes = packed_planes(entry, blocks);
        if (!planes) return planes.error();
        return delta2_.unpack(blocks, *planes, pairs, *step, values);
    }
    const std::span<std::uint32_t> words = at_least(words_, values.size());
    if (Status s = load_planes(entry, 0, entry.stored, std::as_writable_bytes(words), 4); !s) return s;
    from_delta2(words, pairs, *step, values);
    return {};
}

}  // namespace latent::sampledb
