// sampledb/codec/packed_delta2.h: values along records as second differences, one wavelength of many records at a time, in fields
// of few bits. docs/format.md, "Packed delta2".
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/result.h"
#include "sampledb/codec/packed_fields.h"

namespace latent::sampledb {

// How the numbers of a column are cut into blocks: those of whole records, 128 records and one of their k indices at a time; then
// those of the other records, record after record.
class Delta2Blocks {
 public:
    Delta2Blocks() = default;
    Delta2Blocks(std::span<const std::uint16_t> pairs, std::size_t k);

    std::size_t k() const { return k_; }
    std::size_t whole() const { return whole_; }  // records with k pairs
    std::size_t rest() const { return rest_; }    // numbers of the others

    std::size_t count() const { return of_whole() + blocks_of(rest_); }
    std::size_t of_whole() const { return k_ * blocks_of(whole_); }
    // Numbers in a block.
    std::size_t size(std::size_t block) const {
        const bool is_whole = block < of_whole();
        const std::size_t before = (is_whole ? block / k_ : block - of_whole()) * kFieldsPerBlock;
        return std::min((is_whole ? whole_ : rest_) - before, kFieldsPerBlock);
    }
    // The base that it has: that of its index, or the last.
    std::size_t base(std::size_t block) const { return block < of_whole() ? block % k_ : k_; }

 private:
    static std::size_t blocks_of(std::size_t n) { return (n + kFieldsPerBlock - 1) / kFieldsPerBlock; }

    std::size_t k_ = 1, whole_ = 0, rest_ = 0;
};

enum Delta2Plane : std::size_t { kBases, kWidths, kCounts, kFields, kPositions, kExtraLow, kExtraHigh, kDelta2Planes };

// Both keep their memory from column to column.

class Delta2Packer {
 public:
    // `values`, multiples of 2^step (1..22) as bits, of records of `pairs` values, k at most.
    void pack(std::span<const float> values, std::span<const std::uint16_t> pairs, std::size_t k, unsigned step);
    // What it has packed.
    const std::array<Bytes, kDelta2Planes>& planes() const { return planes_; }
    std::size_t size() const;

 private:
    void find_numbers(std::span<const float> values, std::span<const std::uint16_t> pairs, unsigned step);
    void find_bases();
    void pack_block(std::size_t block);

    Delta2Blocks blocks_;
    std::vector<std::uint32_t> numbers_;  // kFieldsPerBlock for each block
    std::vector<std::int32_t> bases_;
    std::array<Bytes, kDelta2Planes> planes_;
};

class Delta2Unpacker {
 public:
    // What the planes behind the first three hold. Errors: kCorrupt (a width, or a number of exceptions, that cannot be).
    struct Sizes {
        std::size_t fields = 0, exceptions = 0;
    };
    static Result<Sizes> sizes(const Delta2Blocks& blocks, ByteSpan widths, ByteSpan counts);

    // Planes of these sizes; `pairs` are those of `blocks`. Errors: kCorrupt (an exception that is not in its block).
    Status unpack(const Delta2Blocks& blocks, std::span<const ByteSpan, kDelta2Planes> planes, std::span<const std::uint16_t> pairs,
                  unsigned step, std::span<float> values);

 private:
    std::vector<std::uint32_t> starts_;  // where whole records begin in the values
    std::vector<std::uint32_t> rest_;    // longer
};

}  // namespace latent::sampledb
