#include "sampledb/codec/column_decode.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "hwy/highway.h"
#include "sampledb/codec/planes.h"
#include "sampledb/data/film_position.h"
#include "sampledb/data/unreadable.h"

namespace latent::sampledb {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

std::uint32_t unzigzag(std::uint32_t coded) { return coded >> 1 ^ (0u - (coded & 1)); }

// Of differences that are counted in steps of 2^step.
std::uint32_t unzigzag(std::uint32_t coded, unsigned step) { return unzigzag(coded) << step; }

constexpr unsigned kMostStep = 22;

Result<unsigned> step_of(const ColumnEntry& entry, bool stepped) {
    if (!stepped) return 0u;
    if (entry.bits < 1 || entry.bits > kMostStep) return corrupt("a step of impossible size");
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

Status ColumnDecoder::load_packed(const ColumnEntry& entry, std::span<std::uint64_t> values) {
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
    if (Status s = load_packed(entry, n); !s) return s;
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

namespace {

// The values of records from their second differences: those of four records of equal length at once, one record in each lane.
class Sums {
 public:
    Sums(std::span<const std::uint32_t> words, unsigned step, std::span<float> values)
        : words_(words.data()), step_(step), values_(values.data()) {}

    // The next record, of n values.
    void add(std::size_t n) {
        if (n < 4) {
            add_up_one(at_, n);
        } else {
            if (n != length_) finish();
            length_ = n;
            starts_[count_++] = at_;
            if (count_ == 4) add_up_four();
        }
        at_ += n;
    }
    // Those that are fewer than four.
    void finish() {
        for (std::size_t i = 0; i < count_; ++i) add_up_one(starts_[i], length_);
        count_ = 0;
    }

 private:
    using Tag = hn::FixedTag<std::uint32_t, 4>;
    using Lanes = hn::Vec<Tag>;

    void add_up_one(std::size_t at, std::size_t n, std::size_t i = 0, std::uint32_t bits = 0, std::uint32_t slope = 0) const {
        for (; i < n; ++i) {
            slope = i == 0 ? 0 : slope + unzigzag(words_[at + i], step_);
            bits = i == 0 ? words_[at] << step_ : bits + slope;
            values_[at + i] = std::bit_cast<float>(bits);
        }
    }

    static void transpose(Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
        const Tag tag;
        const hn::FixedTag<std::uint64_t, 2> two;
        const auto ab = hn::BitCast(two, hn::InterleaveLower(tag, a, b)), cd = hn::BitCast(two, hn::InterleaveLower(tag, c, d));
        const auto ab2 = hn::BitCast(two, hn::InterleaveUpper(tag, a, b)), cd2 = hn::BitCast(two, hn::InterleaveUpper(tag, c, d));
        a = hn::BitCast(tag, hn::InterleaveLower(two, ab, cd)), b = hn::BitCast(tag, hn::InterleaveUpper(two, ab, cd));
        c = hn::BitCast(tag, hn::InterleaveLower(two, ab2, cd2)), d = hn::BitCast(tag, hn::InterleaveUpper(two, ab2, cd2));
    }

    void add_up_four() {
        const Tag tag;
        const int step = static_cast<int>(step_);
        auto bits = hn::Zero(tag), slope = hn::Zero(tag);
        const auto next = [&](Lanes& coded) {
            const auto sign = hn::Sub(hn::Zero(tag), hn::And(coded, hn::Set(tag, 1)));
            slope = hn::Add(slope, hn::ShiftLeftSame(hn::Xor(hn::ShiftRight<1>(coded), sign), step));
            coded = bits = hn::Add(bits, slope);
        };
        std::size_t i = 0;
        for (; i + 4 <= length_; i += 4) {
            const auto load = [&](std::size_t record) { return hn::LoadU(tag, words_ + starts_[record] + i); };
            auto a = load(0), b = load(1), c = load(2), d = load(3);
            transpose(a, b, c, d);
            if (i == 0) {
                a = bits = hn::ShiftLeftSame(a, step);
            } else {
                next(a);
            }
            next(b), next(c), next(d);
            transpose(a, b, c, d);
            const auto store = [&](std::size_t record, Lanes v) {
                hn::StoreU(hn::BitCast(hn::FixedTag<float, 4>(), v), hn::FixedTag<float, 4>(), values_ + starts_[record] + i);
            };
            store(0, a), store(1, b), store(2, c), store(3, d);
        }
        std::array<std::uint32_t, 4> before, difference;
        hn::StoreU(bits, tag, before.data());
        hn::StoreU(slope, tag, difference.data());
        for (std::size_t r = 0; r < 4 && i < length_; ++r) add_up_one(starts_[r], length_, i, before[r], difference[r]);
        count_ = 0;
    }

    const std::uint32_t* words_;
    unsigned step_;
    float* values_;
    std::size_t at_ = 0;
    std::size_t length_ = 0, count_ = 0;  // of the records that wait
    std::array<std::size_t, 4> starts_{};
};

}  // namespace

Status ColumnDecoder::along_records(const ColumnEntry& entry, std::span<float> values, std::span<const std::uint16_t> pairs) {
    const std::span<std::byte> bytes = std::as_writable_bytes(values);
    const bool stepped = entry.transform == Transform::kSteppedDelta2;
    if (entry.transform != Transform::kDelta2 && !stepped) return plain(entry, bytes, 4);
    const Result<unsigned> step = step_of(entry, stepped);
    if (!step) return step.error();
    const std::span<std::uint32_t> words = at_least(words_, values.size());
    if (Status s = load_planes(entry, 0, entry.stored, std::as_writable_bytes(words), 4); !s) return s;
    Sums sums(words, *step, values);
    for (const std::uint16_t n : pairs) sums.add(n);
    sums.finish();
    return {};
}

}  // namespace latent::sampledb
