#include "tools/inspect/strict_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "sampledb/codec/column_decode.h"
#include "sampledb/codec/packed_fields.h"
#include "sampledb/codec/page_decoder.h"
#include "sampledb/codec/page_layout.h"
#include "sampledb/codec/planes.h"

namespace latent::inspect {

using namespace sampledb;

namespace {

// The bits of a plane from number `count` on, `bits` to a number, are zero.
bool padding_is_zero(ByteSpan packed, std::size_t count, unsigned bits) {
    const std::size_t used = count * bits, whole = used / 8;
    if (used % 8 != 0 && std::to_integer<unsigned>(packed[whole]) >> used % 8 != 0) return false;
    return std::ranges::all_of(packed.subspan(whole + (used % 8 != 0)), [](std::byte b) { return b == std::byte{0}; });
}

// Log2 of the window that a zstd frame wants, rounded up [RFC8878 3.1.1.1]; 0 for one that is no larger than its content.
int window_log(ByteSpan frame) {
    const auto byte = [&](std::size_t i) { return i < frame.size() ? std::to_integer<unsigned>(frame[i]) : 0; };
    const bool single_segment = (byte(4) >> 5 & 1) != 0;
    if (single_segment) return 0;
    return static_cast<int>(10 + (byte(5) >> 3) + ((byte(5) & 7) != 0 ? 1 : 0));
}

bool is_packed(Transform transform) {
    return transform == Transform::kPacked || transform == Transform::kLattice || transform == Transform::kPixels;
}

class PageCheck {
 public:
    PageCheck(const Job& job, const PageInfo& info, ByteSpan stored, std::size_t run, std::size_t number, Violations& violations)
        : job_(job), info_(info), stored_(stored), run_(run), number_(number), violations_(violations) {}

    Status check() {
        if (Status s = read_table(job_, info_, stored_, table_); !s) return s;
        Result<std::vector<StoredColumn>> columns = stored_columns(job_, info_, stored_);
        if (!columns) return columns.error();
        columns_ = std::move(*columns);
        for (const ColumnEntry& entry : table_) {
            check_fields(entry);
            if (Status s = check_planes(entry); !s) return s;
        }
        return {};
    }

 private:
    void check_fields(const ColumnEntry& entry) {
        const bool packed = is_packed(entry.transform);
        const bool stepped = entry.transform >= Transform::kSteppedCross && entry.transform <= Transform::kPackedDelta2;
        if (!packed && !stepped && entry.bits != 0)
            wrong(entry, "", fmt::format("bits is {}", entry.bits), "0, unless the transform is 1, 2 or 8 to 12");
        if (stepped && (job_.precision == kFullPrecision || entry.bits != kFullPrecision - job_.precision))
            wrong(entry, "", fmt::format("transform {} with {} bits", static_cast<int>(entry.transform), entry.bits),
                  fmt::format("none of transforms 8 to 11 with a precision of 23 bits, else 23 less the precision, which is {}",
                              job_.precision));
        if (!packed && entry.base != 0)
            wrong(entry, "", fmt::format("base is {:#x}", entry.base), "0, unless the transform is 1, 2 or 12");
        if (entry.transform != Transform::kLattice && entry.lattice_bits != 0)
            wrong(entry, "", fmt::format("s is {}", entry.lattice_bits), "0, unless the transform is 2");
        const std::size_t width = columns_[number_of(entry)].decoded / std::max<std::size_t>(values_of(entry.column), 1);
        if (packed && entry.bits == 0 && width < 8 && entry.base >> 8 * width != 0) {
            wrong(entry, "", fmt::format("base is {:#x}", entry.base), fmt::format("zero above its {} low bytes", width));
        }
        if (entry.transform == Transform::kSampler && info_.record_class == RecordClass::kLight)
            wrong(entry, "", "positions are left out of a light page", "transform 3 in camera pages only");
        if (values_of(entry.column) == 0 && (entry.transform != Transform::kPlanes || !entry.planes.empty())) {
            wrong(entry, "",
                  fmt::format("has no values, but transform {} and {} planes", static_cast<int>(entry.transform),
                              entry.planes.size()),
                  "transform 0 and no planes");
        }
    }

    // Planes in the order of their storage.
    Status check_planes(const ColumnEntry& entry) {
        if (values_of(entry.column) == 0) return {};
        packed_ = {};
        if (entry.transform == Transform::kPackedDelta2) {
            if (Status s = check_packed_delta2(entry); !s) return s;
        }
        ByteSpan rest = entry.stored;
        for (std::size_t p = 0; p < entry.planes.size(); ++p) {
            const PlaneEntry& plane = entry.planes[p];
            const ByteSpan stored = rest.first(plane.stored_size);
            rest = rest.subspan(plane.stored_size);
            const std::size_t size = plane_size(entry, p);
            const std::string place = fmt::format(", plane {}", p);
            if (plane.codec == PlaneCodec::kDictionary) check_dictionary(entry, place, stored, size);
            if (plane.codec == PlaneCodec::kZstd && window_log(stored) > kMaxWindowLog) {
                wrong(entry, place, fmt::format("its zstd frame needs a window of up to 2^{} bytes", window_log(stored)),
                      fmt::format("2^{} at most", kMaxWindowLog));
            }
            if (!is_packed(entry.transform)) continue;
            const Result<ByteSpan> bytes = planes_.decode(plane, stored, size, scratch_);
            if (!bytes) return bytes.error();
            if (!padding_is_zero(*bytes, values_of(entry.column), entry.bits))
                wrong(entry, place, "padding bits after the last number are set", "zero");
        }
        return {};
    }

    // Bits that no field uses, and exceptions that are none.
    Status check_packed_delta2(const ColumnEntry& entry) {
        std::vector<std::uint16_t> pairs(info_.record_count);
        const auto column = std::ranges::find(table_, Column::kPairs, &ColumnEntry::column);
        if (Status s = decoder_.plain(*column, std::as_writable_bytes(std::span(pairs)), sizeof(pairs[0])); !s) return s;
        const Delta2Blocks blocks(pairs, job_.batch);
        const Result<ColumnDecoder::PackedPlanes> planes = decoder_.packed_planes(entry, blocks);
        if (!planes) return planes.error();
        packed_ = *planes;
        bool padded = false, ascending = true, needed = true;
        std::size_t field = 0, exception = 0;
        for (std::size_t block = 0; block < blocks.count(); ++block) {
            const unsigned bits = std::to_integer<unsigned>(packed_[kWidths][block]);
            const std::size_t size = packed_fields_size(blocks.size(block), bits);
            padded |= has_padding(packed_[kFields].subspan(field, size), blocks.size(block), bits);
            field += size;
            const std::size_t first = exception, end = first + std::to_integer<std::size_t>(packed_[kCounts][block]);
            for (; exception < end; ++exception) {
                ascending &= exception == first || packed_[kPositions][exception - 1] < packed_[kPositions][exception];
                needed &= packed_[kExtraLow][exception] != std::byte{0} || packed_[kExtraHigh][exception] != std::byte{0};
            }
        }
        if (padded) wrong(entry, fmt::format(", plane {}", +kFields), "bits that no field uses are set", "zero");
        if (!ascending)
            wrong(entry, fmt::format(", plane {}", +kPositions), "positions in a block do not ascend", "ascending positions");
        if (!needed) wrong(entry, fmt::format(", plane {}", +kExtraLow), "an exception adds 0", "no such exception");
        return {};
    }

    // Whether bits of a block are set that none of its n fields uses.
    static bool has_padding(ByteSpan packed, std::size_t n, unsigned bits) {
        if (n == 0 || bits == 0) return false;
        FieldBlock fields;
        unpack_fields(packed.data(), n, bits, fields);
        std::fill(fields.begin() + static_cast<std::ptrdiff_t>(n), fields.end(), 0u);
        Bytes clean(packed.size());
        pack_fields(fields, n, bits, clean.data());
        return !std::ranges::equal(clean, packed);
    }

    void check_dictionary(const ColumnEntry& entry, const std::string& place, ByteSpan stored, std::size_t size) {
        const unsigned bits = std::to_integer<unsigned>(stored[0]);
        const ByteSpan bytes = stored.subspan(1, std::size_t{1} << bits), packed = stored.subspan(1 + bytes.size());
        numbers_.resize(size);
        unpack_bits(packed.first(packed_size(size, bits)), bits, numbers_);
        std::array<bool, 256> used{};
        for (const std::uint64_t number : numbers_) used[number] = true;
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            if (used[i] || bytes[i] == std::byte{0}) continue;
            wrong(entry, place,
                  fmt::format("byte {} of its dictionary is {:#x}, and no value uses it", i, std::to_integer<unsigned>(bytes[i])),
                  "0");
        }
        if (!padding_is_zero(packed, size, bits)) wrong(entry, place, "padding bits after the last number are set", "zero");
    }

    std::size_t values_of(Column number) const {
        std::size_t values = info_.record_count;
        for_each_column([&](auto column) {
            if (column.spec.number == number && column.spec.rows == Rows::kPairs) values = info_.pair_count;
        });
        return values;
    }

    std::size_t plane_size(const ColumnEntry& entry, std::size_t plane) {
        const std::size_t values = values_of(entry.column);
        switch (entry.transform) {
            case Transform::kPacked:
            case Transform::kLattice:
            case Transform::kPixels:
                return packed_size(values, entry.bits);
            case Transform::kPackedDelta2:
                return packed_[plane].size();
            case Transform::kSparse:
                return plane == 0 ? (values + 7) / 8 : stored_rows();
            case Transform::kSparseCross:
            case Transform::kSteppedSparseCross:
                return stored_rows();
            default:
                return values;
        }
    }

    // The rows that a sparse y stores.
    std::size_t stored_rows() {
        if (bright_ != kUnknown) return bright_;
        const auto y = std::ranges::find(table_, Column::kY, &ColumnEntry::column);
        const PlaneEntry& plane = y->planes[0];
        const Result<ByteSpan> bitmap =
            planes_.decode(plane, y->stored.first(plane.stored_size), (info_.record_count + std::size_t{7}) / 8, scratch_);
        bright_ = 0;
        if (!bitmap) return 0;
        for (const std::byte rows : *bitmap) bright_ += static_cast<std::size_t>(std::popcount(std::to_integer<unsigned>(rows)));
        return bright_;
    }

    std::size_t number_of(const ColumnEntry& entry) const { return static_cast<std::size_t>(&entry - table_.data()); }

    void wrong(const ColumnEntry& entry, const std::string& place, std::string what, std::string wanted) {
        violations_.add({.run = run_,
                         .page = number_,
                         .what = fmt::format("column {}{}: {}", columns_[number_of(entry)].name, place, what),
                         .wanted = std::move(wanted)});
    }

    static constexpr std::size_t kUnknown = ~std::size_t{0};
    static constexpr int kMaxWindowLog = 23;

    const Job& job_;
    const PageInfo& info_;
    const ByteSpan stored_;
    const std::size_t run_, number_;
    Violations& violations_;
    std::vector<ColumnEntry> table_;
    std::vector<StoredColumn> columns_;
    std::size_t bright_ = kUnknown;
    PlaneDecoder planes_;
    ColumnDecoder decoder_;
    ColumnDecoder::PackedPlanes packed_;  // those of a column in packed fields
    Bytes scratch_;
    std::vector<std::uint64_t> numbers_;
};

}  // namespace

Status check_page_strictly(const Job& job, const PageInfo& info, ByteSpan stored, std::size_t run, std::size_t number,
                           Violations& violations) {
    return PageCheck(job, info, stored, run, number, violations).check();
}

}  // namespace latent::inspect
