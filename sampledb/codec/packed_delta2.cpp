#include "sampledb/codec/packed_delta2.h"

#include <bit>
#include <cstring>

#include "sampledb/codec/four_by_four.h"
#include "sampledb/codec/zigzag.h"
#include "sampledb/data/unreadable.h"

namespace latent::sampledb {

Delta2Blocks::Delta2Blocks(std::span<const std::uint16_t> pairs, std::size_t k) : k_(k) {
    for (const std::uint16_t n : pairs) {
        whole_ += n == k;
        rest_ += n == k ? 0 : n;
    }
}

namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kExceptionCost = 4;  // bytes: three, and the time to read it
constexpr unsigned kMaxExtraBits = 15;     // bits of an exception above its field; one more is the sign
constexpr std::size_t kLooksForBase = 64;  // numbers that a base is the median of
constexpr unsigned kNumberBits = 32;       // the most that a number less its base has

// What is in the middle of a field's range: fields are differences to it.
std::uint32_t min_of(std::uint32_t base, unsigned bits) { return base - (std::uint32_t{1} << bits >> 1); }

// The differences of numbers to a base, and the bits of fields that have room for them: 0 for none, else those of d or -1 - d and
// one for the sign. A float's exponent counts bits; without the second highest it cannot be rounded up.
void find_differences(const std::uint32_t* numbers, std::uint32_t base, FieldBlock& differences, FieldBlock& bits) {
    const four::Tag tag;
    const hn::FixedTag<std::int32_t, 4> tag_signed;
    const hn::FixedTag<float, 4> tag_float;
    for (std::size_t i = 0; i < kFieldsPerBlock; i += 4) {
        const Four difference = hn::Sub(load(numbers + i), hn::Set(tag, base));
        const auto d = hn::BitCast(tag_signed, difference);
        const auto magnitude = hn::Xor(d, hn::ShiftRight<31>(d));
        const auto rounded_down = hn::AndNot(hn::ShiftRight<1>(magnitude), magnitude);
        const auto exponent = hn::ShiftRight<23>(hn::BitCast(tag_signed, hn::ConvertTo(tag_float, rounded_down)));
        const auto needed = hn::Max(hn::Sub(exponent, hn::Set(tag_signed, 125)), hn::Set(tag_signed, 1));
        store(difference, &differences[i]);
        store(hn::BitCast(tag, hn::IfThenElseZero(hn::Ne(d, hn::Zero(tag_signed)), needed)), &bits[i]);
    }
}

}  // namespace

void Delta2Packer::pack(std::span<const float> values, std::span<const std::uint16_t> pairs, std::size_t k, unsigned step) {
    blocks_ = Delta2Blocks(pairs, k);
    for (Bytes& plane : planes_) plane.clear();
    find_numbers(values, pairs, step);
    find_bases();
    for (std::size_t block = 0; block < blocks_.count(); ++block) pack_block(block);
}

std::size_t Delta2Packer::size() const {
    std::size_t size = 0;
    for (const Bytes& plane : planes_) size += plane.size();
    return size;
}

// First values and second differences in steps of 2^step, as they stand in the blocks.
void Delta2Packer::find_numbers(std::span<const float> values, std::span<const std::uint16_t> pairs, unsigned step) {
    numbers_.resize(blocks_.count() * kFieldsPerBlock);
    const float* from = values.data();
    std::size_t whole = 0;
    std::uint32_t* rest = numbers_.data() + blocks_.of_whole() * kFieldsPerBlock;
    for (const std::uint16_t n : pairs) {
        const bool is_whole = n == blocks_.k();
        std::uint32_t* to = rest;
        if (is_whole) {
            to = &numbers_[whole / kFieldsPerBlock * blocks_.k() * kFieldsPerBlock + whole % kFieldsPerBlock];
            ++whole;
        } else {
            rest += n;
        }
        const std::size_t apart = is_whole ? kFieldsPerBlock : 1;
        std::uint32_t before = 0, slope = 0;
        for (std::uint16_t i = 0; i < n; ++i) {
            const std::uint32_t bits = std::bit_cast<std::uint32_t>(*from++);
            to[i * apart] = i == 0 ? bits >> step : in_steps(bits - before - slope, step);
            slope = i == 0 ? 0 : bits - before;
            before = bits;
        }
    }
}

// About the medians, from a few numbers of each kind.
void Delta2Packer::find_bases() {
    bases_.assign(blocks_.k() + 1, 0);
    std::array<std::int32_t, kLooksForBase> seen;
    for (std::size_t base = 0; base <= blocks_.k(); ++base) {
        const bool is_whole = base < blocks_.k();
        const std::size_t n = is_whole ? blocks_.whole() : blocks_.rest();
        const std::size_t looks = std::min(n, kLooksForBase);
        if (looks == 0) continue;
        const std::size_t first = is_whole ? base : blocks_.of_whole(), apart = is_whole ? blocks_.k() : 1;
        for (std::size_t i = 0; i < looks; ++i) {
            const std::size_t at = i * n / looks;
            seen[i] = static_cast<std::int32_t>(
                numbers_[(first + at / kFieldsPerBlock * apart) * kFieldsPerBlock + at % kFieldsPerBlock]);
        }
        std::nth_element(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(looks / 2),
                         seen.begin() + static_cast<std::ptrdiff_t>(looks));
        bases_[base] = seen[looks / 2];
    }
    planes_[kBases].resize(bases_.size() * sizeof(bases_[0]));
    std::memcpy(planes_[kBases].data(), bases_.data(), planes_[kBases].size());
}

void Delta2Packer::pack_block(std::size_t block) {
    const std::size_t n = blocks_.size(block);
    const auto base = static_cast<std::uint32_t>(bases_[blocks_.base(block)]);
    const std::uint32_t* const numbers = &numbers_[block * kFieldsPerBlock];
    FieldBlock differences, needs;
    find_differences(numbers, base, differences, needs);
    std::array<std::array<std::uint8_t, kNumberBits + 1>, 4> counts{};  // four, so that equal neighbours do not wait for each other
    for (std::size_t i = 0; i < n; ++i) ++counts[i % 4][needs[i]];
    const auto with_bits = [&](unsigned bits) {
        return std::size_t{counts[0][bits]} + counts[1][bits] + counts[2][bits] + counts[3][bits];
    };
    unsigned most = kNumberBits;
    while (most > 0 && with_bits(most) == 0) --most;
    const unsigned least = most > kMaxExtraBits ? most - kMaxExtraBits : 0;
    unsigned bits = 0;
    std::size_t exceptions = 0, best = ~std::size_t{0}, wider = 0;
    for (unsigned width = most + 1; width-- > least; wider += with_bits(width)) {
        const std::size_t cost = packed_fields_size(n, width) + kExceptionCost * wider;
        if (width <= kMaxFieldBits && cost < best) best = cost, bits = width, exceptions = wider;
    }
    planes_[kWidths].push_back(static_cast<std::byte>(bits));
    planes_[kCounts].push_back(static_cast<std::byte>(exceptions));

    const std::uint32_t middle = std::uint32_t{1} << bits >> 1, mask = (std::uint32_t{1} << bits) - 1;
    FieldBlock fields{};
    for (std::size_t i = 0; i < n; ++i) fields[i] = (differences[i] + middle) & mask;
    for (std::size_t i = 0; i < n && exceptions > 0; ++i) {
        if (needs[i] <= bits) continue;
        const std::int64_t extra = (std::int64_t{static_cast<std::int32_t>(differences[i])} + middle) >> bits;
        planes_[kPositions].push_back(static_cast<std::byte>(i));
        planes_[kExtraLow].push_back(static_cast<std::byte>(extra & 0xFF));
        planes_[kExtraHigh].push_back(static_cast<std::byte>(extra >> 8 & 0xFF));
    }
    Bytes& packed = planes_[kFields];
    const std::size_t size = packed_fields_size(n, bits);
    packed.resize(packed.size() + size);
    pack_fields(fields, n, bits, packed.data() + packed.size() - size);
}

namespace {

// The blocks of a column, one after another.
class BlockReader {
 public:
    BlockReader(const Delta2Blocks& blocks, std::span<const ByteSpan, kDelta2Planes> planes) : blocks_(blocks), planes_(planes) {}

    // Numbers are fields + least(). False if an exception is not in the block.
    bool next(FieldBlock& fields) {
        const std::size_t n = blocks_.size(block_);
        const unsigned bits = std::to_integer<unsigned>(planes_[kWidths][block_]);
        unpack_fields(planes_[kFields].data() + field_, n, bits, fields);
        field_ += packed_fields_size(n, bits);
        least_ = min_of(load_le<std::uint32_t>(&planes_[kBases][sizeof(std::uint32_t) * blocks_.base(block_)]), bits);
        const std::size_t end = exception_ + std::to_integer<std::size_t>(planes_[kCounts][block_]);
        for (; exception_ < end; ++exception_) {
            const std::size_t position = std::to_integer<std::size_t>(planes_[kPositions][exception_]);
            if (position >= n) return false;
            const auto extra = static_cast<std::int16_t>(std::to_integer<unsigned>(planes_[kExtraHigh][exception_]) << 8 |
                                                         std::to_integer<unsigned>(planes_[kExtraLow][exception_]));
            fields[position] += static_cast<std::uint32_t>(extra) << bits;
        }
        ++block_;
        return true;
    }
    std::uint32_t least() const { return least_; }

 private:
    const Delta2Blocks& blocks_;
    const std::span<const ByteSpan, kDelta2Planes> planes_;
    std::size_t block_ = 0, field_ = 0, exception_ = 0;
    std::uint32_t least_ = 0;
};

// Up to 128 records, a value of each after the other.
class Tile {
 public:
    Tile(std::span<const std::uint32_t> starts, unsigned step, float* values)
        : starts_(starts), step_(static_cast<int>(step)), values_(values) {}

    // The numbers of the next index, field + least.
    void add(const FieldBlock& fields, std::uint32_t least) {
        const four::Tag tag;
        const Four base = hn::Set(tag, least);
        const FieldBlock& before = rows_[(index_ + 3) % 4];
        FieldBlock& row = rows_[index_ % 4];
        for (std::size_t i = 0; i < starts_.size(); i += 4) {
            const Four slope = hn::Add(load(&slope_[i]), hn::Add(load(&fields[i]), base));
            store(slope, &slope_[i]);
            store(hn::Add(load(&before[i]), slope), &row[i]);
        }
        if (index_ == 0) slope_ = {};  // it was the first value
        if (++index_ % 4 == 0) put_four();
    }
    // After the last index.
    void finish() {
        for (std::size_t i = index_ / 4 * 4; i < index_; ++i) put(i, 0);
    }

 private:
    // The last four values of each record.
    void put_four() const {
        float* const values = values_ + (index_ - 4);
        std::size_t i = 0;
        for (; i + 4 <= starts_.size(); i += 4) {
            const FourByFour at =
                FourByFour{load(&rows_[0][i]), load(&rows_[1][i]), load(&rows_[2][i]), load(&rows_[3][i])}.transposed();
            store(hn::ShiftLeftSame(at.a, step_), values + starts_[i]);
            store(hn::ShiftLeftSame(at.b, step_), values + starts_[i + 1]);
            store(hn::ShiftLeftSame(at.c, step_), values + starts_[i + 2]);
            store(hn::ShiftLeftSame(at.d, step_), values + starts_[i + 3]);
        }
        for (std::size_t index = index_ - 4; index < index_; ++index) put(index, i);
    }
    // Value `index` of the records from `first` on.
    void put(std::size_t index, std::size_t first) const {
        for (std::size_t i = first; i < starts_.size(); ++i)
            values_[starts_[i] + index] = std::bit_cast<float>(rows_[index % 4][i] << step_);
    }

    const std::span<const std::uint32_t> starts_;
    const int step_;
    float* const values_;
    std::size_t index_ = 0;
    FieldBlock slope_{};
    std::array<FieldBlock, 4> rows_{};  // the last values, in steps
};

}  // namespace

Result<Delta2Unpacker::Sizes> Delta2Unpacker::sizes(const Delta2Blocks& blocks, ByteSpan widths, ByteSpan counts) {
    Sizes sizes;
    for (std::size_t block = 0; block < blocks.count(); ++block) {
        const std::size_t n = blocks.size(block), exceptions = std::to_integer<std::size_t>(counts[block]);
        const unsigned bits = std::to_integer<unsigned>(widths[block]);
        if (bits > kMaxFieldBits || exceptions > n) return corrupt("a block of fields of impossible size");
        sizes.fields += packed_fields_size(n, bits);
        sizes.exceptions += exceptions;
    }
    return sizes;
}

Status Delta2Unpacker::unpack(const Delta2Blocks& blocks, std::span<const ByteSpan, kDelta2Planes> planes,
                              std::span<const std::uint16_t> pairs, unsigned step, std::span<float> values) {
    const auto misplaced = [] { return corrupt("an exception outside its block"); };
    starts_.clear();
    std::uint32_t start = 0;
    for (const std::uint16_t n : pairs) {
        if (n == blocks.k()) starts_.push_back(start);
        start += n;
    }
    BlockReader reader(blocks, planes);
    FieldBlock fields;
    for (std::size_t first = 0; first < starts_.size(); first += kFieldsPerBlock) {
        const std::span<const std::uint32_t> starts(&starts_[first], std::min(kFieldsPerBlock, starts_.size() - first));
        Tile tile(starts, step, values.data());
        for (std::size_t i = 0; i < blocks.k(); ++i) {
            if (!reader.next(fields)) return misplaced();
            tile.add(fields, reader.least());
        }
        tile.finish();
    }
    if (blocks.rest() == 0) return {};
    rest_.clear();
    while (rest_.size() < blocks.rest()) {
        if (!reader.next(fields)) return misplaced();
        const std::size_t n = std::min(kFieldsPerBlock, blocks.rest() - rest_.size());
        for (std::size_t i = 0; i < n; ++i) rest_.push_back(fields[i] + reader.least());
    }
    const std::uint32_t* next = rest_.data();
    float* to = values.data();
    for (const std::uint16_t n : pairs) {
        if (n != blocks.k()) {
            std::uint32_t value = 0, slope = 0;
            for (std::size_t i = 0; i < n; ++i) {
                slope = i == 0 ? 0 : slope + *next;
                value = i == 0 ? *next : value + slope;
                to[i] = std::bit_cast<float>(value << step);
                ++next;
            }
        }
        to += n;
    }
    return {};
}

}  // namespace latent::sampledb
