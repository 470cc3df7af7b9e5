// sampledb/codec/page_layout.h: what the encoder and the decoder of pages share: transforms, the table at a page's front.
#pragma once

#include <array>
#include <bit>
#include <cassert>
#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/result.h"
#include "sampledb/codec/plane_codec.h"
#include "sampledb/data/job.h"
#include "sampledb/data/page.h"

namespace latent::sampledb {

static_assert(std::endian::native == std::endian::little, "columns are copied to and from disk as they stand in memory");

enum class Transform : std::uint8_t {
    kPlanes = 0,         // the values' byte planes
    kPacked = 1,         // value = base + `bits` bits; 0 bits: a constant column
    kLattice = 2,        // sample numbers, by the bits that a base 2 radical inverse makes of them
    kSampler = 3,        // u and v follow from the sample numbers
    kCross = 4,          // x and z: zigzag of the difference to y's bits
    kDelta2 = 5,         // power and lambda: zigzag of second differences along each record
    kSparse = 6,         // y: which rows are not zero, and the planes of those
    kSparseCross = 7,    // x and z: as kCross, of the rows where y is not zero; zero in the others
    kSteppedCross = 8,   // these three as kCross, kDelta2 and kSparseCross, of differences that are multiples of 2^bits,
    kSteppedDelta2 = 9,  //   counted in these
    kSteppedSparseCross = 10,
    kPackedDelta2 = 11,  // as kSteppedDelta2, in fields of few bits instead of byte planes
    kPixels = 12,        // sample numbers, by pixel and pass
};

constexpr std::size_t kColumnEntrySize = 24;
// One column of a page's table. kColumnEntrySize bytes on disk, then one word per plane.
struct ColumnEntry {
    Column column{};
    Transform transform = Transform::kPlanes;
    std::uint8_t bits = 0;          // for kPacked, kLattice and kPixels; the step of kStepped... and kPackedDelta2
    std::uint8_t lattice_bits = 0;  // s of kLattice
    std::uint64_t base = 0;
    std::uint64_t hash = 0;  // XXH3-64 of the decoded values
    std::vector<PlaneEntry> planes{};
    ByteSpan stored{};  // decoding: its planes
};
constexpr std::size_t kMaxPlanes = 8;

// The number of the job's extra column `i`.
constexpr Column extra_number(std::size_t i) { return static_cast<Column>(static_cast<std::size_t>(Column::kFirstExtra) + i); }

// Reads the table at the front of a page's stored bytes and finds those of each column. What was in `table` lends its memory.
// Errors: kCorrupt.
Status read_table(const Job& job, const PageInfo& info, ByteSpan stored, std::vector<ColumnEntry>& table);

// XXH3-64 over the hashes of the decoded columns.
std::uint64_t content_hash(const std::vector<ColumnEntry>& table);

// The first `count` values of a column, which may be longer (Page::kPadding).
template <class T>
std::span<const T> rows(const std::vector<T>& column, std::size_t count) {
    assert(column.size() >= count);
    return {column.data(), count};
}

// The same of a buffer, which grows if it has to.
template <class T>
std::span<T> at_least(std::vector<T>& buffer, std::size_t count) {
    if (buffer.size() < count) buffer.resize(count);
    return {buffer.data(), count};
}

}  // namespace latent::sampledb
