// sampledb/data/record.h: records in memory, as columns. What a renderer emits, a page decodes to, and a darkroom weighs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace latent::sampledb {

enum class RecordKind : std::uint8_t { kSpectral = 1, kXyz = 2 };   // what a record stores; one kind per job
enum class RecordClass : std::uint8_t { kCamera = 0, kLight = 1 };  // radiance seen at (u,v) | energy that reached the film there

inline constexpr std::uint16_t kMaxPairs = 1024;   // pairs of one spectral record
inline constexpr std::uint16_t kNoIndex = 0xFFFF;  // the record keeps its whole batch, or nothing

// A further column that the job names: one value of fixed width per record.
enum class ColumnType : std::uint8_t { kU8 = 1, kU16 = 2, kU32 = 3, kU64 = 4, kF32 = 5, kF64 = 6 };
std::size_t width(ColumnType type);  // bytes of one value; 0 for a type that does not exist
struct ExtraColumn {
    std::string name;  // "light_group", "depth", ...
    ColumnType type;
    std::vector<std::byte> values;  // little-endian, one after another
};

// Records as columns; every column that applies has `size()` rows, the others are empty.
struct Records {
    std::vector<std::uint64_t> sample;  // sample number
    std::vector<RecordClass> record_class;
    std::vector<std::uint32_t> u, v;  // film position, floor(x 2^32)
    std::vector<float> share;         // of the sample's denominator; camera records only, 0 in light records

    std::vector<float> x, y, z;  // kXyz

    std::vector<std::uint16_t> pairs;  // kSpectral: n, the pairs that this record stores, 0..k (0: black)
    std::vector<std::uint32_t> xi;     //   jobs with a density: the batch's offset, floor(xi 2^32)
    std::vector<std::uint16_t> index;  //   jobs with a density: which wavelength a record with n = 1 < k keeps; else kNoIndex
    std::vector<float> power;          //   all pairs of all records, one record after another
    std::vector<float> lambda_nm;      //   the same, in jobs without a density (foreign writers)

    std::vector<ExtraColumn> extra;  // as the job names them, in its order

    std::size_t size() const { return sample.size(); }
    bool empty() const { return sample.empty(); }
    void clear();
    Records without_rows() const;  // the same extra columns, empty
    // Appends row `row` of `from`, whose pairs begin at `first_pair` of its power column. Same kind, same extra columns.
    void append(const Records& from, std::size_t row, std::size_t first_pair);
    // Bytes that the rows take in these columns.
    std::uint64_t raw_bytes() const;
};

}  // namespace latent::sampledb
