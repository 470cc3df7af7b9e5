#include "sampledb/codec/page_encoder.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

#include "base/hash.h"
#include "sampledb/codec/delta2.h"
#include "sampledb/codec/planes.h"
#include "sampledb/codec/zigzag.h"
#include "sampledb/data/limits.h"
#include "sampledb/data/pixel_lattice.h"
#include "sampledb/data/z_order.h"

namespace latent::sampledb {

namespace {

// The differences of rounded values are multiples of 2^step. `bits`: all of them, or-ed.
unsigned step_of(const Job& job, std::uint32_t bits) {
    const unsigned step = kFullPrecision - job.precision;
    return (bits & ((1u << step) - 1)) == 0 ? step : 0;
}
void set_transform(ColumnEntry& entry, unsigned step, Transform plain, Transform stepped) {
    entry.transform = step == 0 ? plain : stepped;
    entry.bits = static_cast<std::uint8_t>(step);
}

constexpr std::size_t kLookedAt = 1 << 12;  // values from which the size of byte planes is estimated

FilmNode node_of(const Page& page) {
    std::uint32_t different_u = 0, different_v = 0;
    for (std::size_t i = 1; i < page.count; ++i) {
        different_u |= page.u[i] ^ page.u[0];
        different_v |= page.v[i] ^ page.v[0];
    }
    const int level = std::min<int>(kZPrefixLevels, std::countl_zero(different_u | different_v));
    if (level == 0) return {};
    return {static_cast<std::uint8_t>(level), page.u[0] >> (32 - level), page.v[0] >> (32 - level)};
}

void put_table(std::span<const ColumnEntry> table, Bytes& out) {
    ByteWriter to(out);
    to.put(static_cast<std::uint32_t>(table.size()));
    for (const ColumnEntry& entry : table) {
        to.put(static_cast<std::uint8_t>(entry.column));
        to.put(static_cast<std::uint8_t>(entry.transform));
        to.put(entry.bits);
        to.put(static_cast<std::uint8_t>(entry.planes.size()));
        to.put(static_cast<std::uint32_t>(entry.lattice_bits));
        to.put(entry.base);
        to.put(entry.hash);
        for (const PlaneEntry& plane : entry.planes) to.put(plane.word());
    }
}

}  // namespace

// A new entry with its hash; true if nothing is to be stored but its `base`: all values are equal, or there are none.
bool PageEncoder::begin_column(Column number, ByteSpan values, std::size_t value_width) {
    ColumnEntry& entry = table_.emplace_back();
    entry.column = number;
    entry.hash = hash64(values);
    if (values.empty()) return true;
    if (std::memcmp(values.data(), values.data() + value_width, values.size() - value_width) != 0) return false;
    entry.transform = Transform::kPacked;
    std::memcpy(&entry.base, values.data(), value_width);
    return true;
}

void PageEncoder::store_planes(ByteSpan values, std::size_t value_width) {
    const std::span<std::byte> planes = at_least(scratch_, values.size());
    split_planes(values, value_width, planes);
    const std::size_t n = values.size() / value_width;
    for (std::size_t p = 0; p < value_width; ++p)
        table_.back().planes.push_back(planes_.encode(planes.subspan(p * n, n), payload_, choice_));
}

void PageEncoder::store_packed(std::span<const std::uint64_t> values, unsigned bits) {
    table_.back().bits = static_cast<std::uint8_t>(bits);
    if (bits == 0) return;
    scratch_.clear();
    pack_bits(values, bits, scratch_);
    table_.back().planes.push_back(planes_.encode(scratch_, payload_, choice_));
}

void PageEncoder::encode_plain(Column number, ByteSpan values, std::size_t value_width) {
    if (!begin_column(number, values, value_width)) store_planes(values, value_width);
}

// Where the job's sampler puts the samples of a camera page, and whether that is where they are.
void PageEncoder::find_positions(const Job& job, const Page& page) {
    sampled_ = page.record_class == RecordClass::kCamera && job.positions.sampler != PositionSampler::kNone;
    derived_ = false;
    if (!sampled_) return;
    const std::span<std::uint32_t> u = at_least(u_, page.count), v = at_least(v_, page.count);
    positions_of(rows(page.sample, page.count), job.positions, u, v);
    derived_ = std::ranges::equal(rows(page.u, page.count), u) && std::ranges::equal(rows(page.v, page.count), v);
}

void PageEncoder::encode_samples(const Job& job, std::span<const std::uint64_t> n) {
    if (begin_column(Column::kSample, std::as_bytes(n), 8)) return;
    std::uint64_t low = n[0], high = n[0];
    for (const std::uint64_t value : n) low = std::min(low, value), high = std::max(high, value);
    if (encode_pixels(job, n, low, high) || encode_lattice(job, n, low, high)) return;
    ColumnEntry& entry = table_.back();
    entry.transform = Transform::kPacked;
    entry.base = low;
    const std::span<std::uint64_t> numbers = at_least(numbers_, n.size());
    for (std::size_t i = 0; i < n.size(); ++i) numbers[i] = n[i] - low;
    store_packed(numbers, static_cast<unsigned>(std::bit_width(high - low)));
}

// A page holds all samples of few pixels, so their numbers are known by the pixel and the pass. False if samples lie elsewhere, or
// there is nothing to gain.
bool PageEncoder::encode_pixels(const Job& job, std::span<const std::uint64_t> n, std::uint64_t low, std::uint64_t high) {
    if (!derived_ || job.positions.sampler != PositionSampler::kPixels) return false;
    const PixelLattice lattice(job.positions);
    const PixelLattice::Block block = lattice.block(node_);
    const std::uint64_t first = lattice.place(low).pass;
    const std::span<std::uint64_t> numbers = at_least(numbers_, n.size());
    std::uint64_t all = 0;
    for (std::size_t i = 0; i < n.size(); ++i) all |= numbers[i] = block.number(lattice.place(n[i]), first);
    const unsigned bits = static_cast<unsigned>(std::bit_width(all));
    if (bits >= static_cast<unsigned>(std::bit_width(high - low))) return false;
    ColumnEntry& entry = table_.back();
    entry.transform = Transform::kPixels;
    entry.base = first;
    store_packed(numbers, bits);
    return true;
}

// Sample numbers within a node differ where u does: their reversed low bits are near each other. n = h 2^s + rev_s(f), and
// f - f0 (mod 2^s) takes about s - level bits, against s for n itself. u without its shift is n reversed, of which the 32 - s low
// bits are the same for all. False if there is no sampler, or nothing to gain.
bool PageEncoder::encode_lattice(const Job& job, std::span<const std::uint64_t> n, std::uint64_t low, std::uint64_t high) {
    const int s = std::bit_width(low ^ high);
    if (!sampled_ || job.positions.sampler != PositionSampler::kHalton23 || s > 32) return false;
    const std::span<const std::uint32_t> u = rows(u_, n.size());
    std::int32_t least = 0, most = 0;
    for (const std::uint32_t at : u) {
        const std::int32_t d = static_cast<std::int32_t>(at - u[0]);
        least = std::min(least, d), most = std::max(most, d);
    }
    const unsigned bits = static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(std::int64_t{most} - least) >> (32 - s)));
    if (bits >= static_cast<unsigned>(std::bit_width(high - low))) return false;
    const std::span<std::uint64_t> numbers = at_least(numbers_, n.size());
    const std::uint32_t f0 = u[0] + static_cast<std::uint32_t>(least);
    for (std::size_t i = 0; i < n.size(); ++i) numbers[i] = (u[i] - f0) >> (32 - s);
    ColumnEntry& entry = table_.back();
    entry.transform = Transform::kLattice;
    entry.lattice_bits = static_cast<std::uint8_t>(s);
    entry.base = n[0] >> s << s | (reverse_bits(f0 - job.positions.shift_u) & ((std::uint64_t{1} << s) - 1));
    store_packed(numbers, bits);
    return true;
}

void PageEncoder::encode_position(Column number, std::span<const std::uint32_t> positions) {
    if (!derived_) return encode_plain(number, std::as_bytes(positions), 4);
    ColumnEntry& entry = table_.emplace_back();
    entry.column = number;
    entry.transform = Transform::kSampler;
    entry.hash = hash64(std::as_bytes(positions));
}

// Black records are so in x, y and z, and the mantissas of bright ones are noise: where a sixteenth is black, only bright rows are
// stored.
void PageEncoder::find_bright_rows(std::span<const float> y) {
    bright_count_ = find_nonzero(std::as_bytes(y), bright_);
    sparse_ = bright_count_ > 0 && bright_count_ <= y.size() - (y.size() + 15) / 16;
}

void PageEncoder::store_bright(std::span<std::uint32_t> words) {
    compress(bright_, words);
    store_planes(std::as_bytes(words.first(bright_count_)), 4);
}

void PageEncoder::encode_luminance(std::span<const float> y) {
    if (!sparse_) return encode_plain(Column::kY, std::as_bytes(y), 4);
    begin_column(Column::kY, std::as_bytes(y), 4);  // never constant: some rows are black and some are not
    table_.back().transform = Transform::kSparse;
    table_.back().planes.push_back(planes_.encode(bright_, payload_, choice_));
    const std::span<std::uint32_t> words = at_least(words_, y.size());
    std::memcpy(words.data(), y.data(), y.size_bytes());
    store_bright(words);
}

void PageEncoder::encode_crossed(const Job& job, Column number, std::span<const float> values, std::span<const float> y) {
    if (begin_column(number, std::as_bytes(values), 4)) return;
    const std::span<std::uint32_t> words = at_least(words_, values.size());
    std::uint32_t elsewhere = 0, all = 0;  // bits that are set in values where y is 0, and in all differences
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::uint32_t bits = std::bit_cast<std::uint32_t>(values[i]), of_y = std::bit_cast<std::uint32_t>(y[i]);
        words[i] = bits - of_y;
        all |= bits - of_y;
        elsewhere |= of_y == 0 ? bits : 0;
    }
    const unsigned step = step_of(job, all);
    for (std::uint32_t& word : words) word = zigzag(word, step);
    if (sparse_ && elsewhere == 0) {
        set_transform(table_.back(), step, Transform::kSparseCross, Transform::kSteppedSparseCross);
        store_bright(words);
    } else {
        set_transform(table_.back(), step, Transform::kCross, Transform::kSteppedCross);
        store_planes(std::as_bytes(words), 4);
    }
}

void PageEncoder::encode_along_records(const Job& job, Column number, std::span<const float> values,
                                       std::span<const std::uint16_t> pairs) {
    if (begin_column(number, std::as_bytes(values), 4)) return;
    std::uint32_t all = 0;
    for (const float value : values) all |= std::bit_cast<std::uint32_t>(value);
    const unsigned step = step_of(job, all);
    if (step > 0 && encode_packed(job, values, pairs, step)) return;
    const std::span<std::uint32_t> words = at_least(words_, values.size());
    to_delta2(values, pairs, step, words);
    set_transform(table_.back(), step, Transform::kDelta2, Transform::kSteppedDelta2);
    store_planes(std::as_bytes(words), 4);
}

// False if byte planes would be much smaller, as far as a part of the records shows: values that repeat, or of few records.
bool PageEncoder::encode_packed(const Job& job, std::span<const float> values, std::span<const std::uint16_t> pairs,
                                unsigned step) {
    delta2_.pack(values, pairs, job.batch, step);
    if (8 * delta2_.size() > 9 * planes_size(values, pairs, step)) return false;  // they are faster to read
    set_transform(table_.back(), step, Transform::kDelta2, Transform::kPackedDelta2);
    for (std::size_t p = 0; p < kDelta2Planes; ++p) {
        const Bytes& plane = delta2_.planes()[p];
        const bool noise = plane.empty() || p == kFields || p == kPositions;
        table_.back().planes.push_back(noise ? PlaneEncoder::encode_raw(plane, payload_)
                                             : planes_.encode(plane, payload_, kQuickPlanes));
    }
    return true;
}

// About the bytes that the column would take as byte planes.
std::size_t PageEncoder::planes_size(std::span<const float> values, std::span<const std::uint16_t> pairs, unsigned step) {
    const std::size_t every = std::max<std::size_t>(1, values.size() / kLookedAt);
    std::vector<float> some;
    std::vector<std::uint16_t> their_pairs;
    std::size_t at = 0;
    for (std::size_t i = 0; i < pairs.size(); at += pairs[i++]) {
        if (i % every != 0) continue;
        some.insert(some.end(), values.begin() + static_cast<std::ptrdiff_t>(at),
                    values.begin() + static_cast<std::ptrdiff_t>(at + pairs[i]));
        their_pairs.push_back(pairs[i]);
    }
    if (some.empty()) return values.size_bytes();
    const std::span<std::uint32_t> words = at_least(words_, some.size());
    to_delta2(some, their_pairs, step, words);
    const std::span<std::byte> planes = at_least(scratch_, words.size_bytes());
    split_planes(std::as_bytes(words), 4, planes);
    std::size_t size = 0;
    for (std::size_t p = 0; p < 4; ++p) size += PlaneEncoder::estimate(planes.subspan(p * some.size(), some.size()));
    return size * values.size() / some.size();
}

template <std::size_t i>
void PageEncoder::encode_column(const Job& job, const Page& page, ColumnAt<i> column) {
    constexpr auto spec = column.spec;
    using Value = typename ColumnAt<i>::Value;
    if (spec.number == Column::kShare && page.unit_share) {
        const std::span<std::uint32_t> ones = at_least(words_, page.count);
        std::ranges::fill(ones, std::bit_cast<std::uint32_t>(1.0f));
        return encode_plain(spec.number, std::as_bytes(ones), sizeof(Value));
    }
    std::size_t count = page.count;
    if constexpr (spec.rows == Rows::kPairs) count = pair_count_;
    const std::span<const Value> values = rows(page.*spec.values, count);
    if constexpr (spec.coding == Coding::kSample) {
        encode_samples(job, values);
    } else if constexpr (spec.coding == Coding::kPosition) {
        encode_position(spec.number, values);
    } else if constexpr (spec.coding == Coding::kLuminance) {
        encode_luminance(values);
    } else if constexpr (spec.coding == Coding::kCrossed) {
        encode_crossed(job, spec.number, values, rows(page.y, page.count));
    } else if constexpr (spec.coding == Coding::kAlongRecords) {
        encode_along_records(job, spec.number, values, rows(page.pairs, page.count));
    } else {
        encode_plain(spec.number, std::as_bytes(values), sizeof(Value));
    }
}

PageInfo PageEncoder::encode(const Job& job, const Page& page, Bytes& out) {
    assert(page.count > 0 && page.count <= kMaxRecordsPerPage);
    table_.clear();
    payload_.clear();
    pair_count_ = 0;
    // Rounded X, Y, Z take few bytes, and the entropy coder would take a third of the time to read them.
    const bool quick = job.kind == RecordKind::kXyz && job.precision < kFullPrecision;
    choice_ = quick ? kQuickPlanes : kSmallPlanes;
    node_ = node_of(page);
    find_positions(job, page);
    if (job.kind == RecordKind::kXyz) {
        find_bright_rows(rows(page.y, page.count));
    } else {
        for (const std::uint16_t n : rows(page.pairs, page.count)) pair_count_ += n;
    }
    for_each_column([&](auto column) {
        if (has_column(job, page.record_class, column.spec.presence)) encode_column(job, page, column);
    });
    for (std::size_t i = 0; i < job.extra.size(); ++i) {
        const std::size_t value_width = width(job.extra[i].type);
        encode_plain(extra_number(i), rows(page.extra[i].values, page.count * value_width), value_width);
    }

    const std::size_t begin = out.size();
    put_table(table_, out);
    out.insert(out.end(), payload_.begin(), payload_.end());

    PageInfo info{};
    info.node = node_;
    info.record_class = page.record_class;
    info.record_count = static_cast<std::uint32_t>(page.count);
    info.pair_count = static_cast<std::uint32_t>(pair_count_);
    info.stored_size = static_cast<std::uint32_t>(out.size() - begin);
    info.decoded_size = static_cast<std::uint32_t>(decoded_page_size(job, page.record_class, page.count, pair_count_));
    info.stored_hash = hash64(ByteSpan(out).subspan(begin));
    info.content_hash = content_hash(table_);
    return info;
}

}  // namespace latent::sampledb
