// sampledb/data/columns.h: every column of a record: number, name, type, when it is there, how it is stored, where its values are.
// Whatever treats all columns alike loops over this table. docs/format.md, "Page".
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "sampledb/data/limits.h"

namespace latent::sampledb {

enum class RecordKind : std::uint8_t { kSpectral = 1, kXyz = 2 };   // what a record stores; one kind per job
enum class RecordClass : std::uint8_t { kCamera = 0, kLight = 1 };  // radiance seen at (u,v) | energy that reached the film there

// A further column that the job names: one value of fixed width per record.
enum class ColumnType : std::uint8_t { kU8 = 1, kU16 = 2, kU32 = 3, kU64 = 4, kF32 = 5, kF64 = 6 };
std::size_t width(ColumnType type);  // bytes of one value; 0 for a type that does not exist
struct ExtraColumn {
    std::string name;  // "light_group", "depth", ...
    ColumnType type;
    std::vector<std::byte> values;  // little-endian, one after another
};

// The values of records, one after another; columns that do not apply are empty.
struct Columns {
    std::vector<std::uint64_t> sample;  // sample number
    std::vector<std::uint32_t> u, v;    // film position, floor(x 2^32)
    std::vector<float> share;           // part of the sample's denominator; camera records only, 0 in light records

    std::vector<float> x, y, z;  // kXyz

    std::vector<std::uint16_t> pairs;  // kSpectral: n, the pairs that this record stores, 0..k (0: black)
    std::vector<std::uint32_t> xi;     //   jobs with a density: the batch's offset, floor(xi 2^32)
    std::vector<std::uint16_t> index;  //   jobs with a density: which wavelength a record with n = 1 < k keeps; else kNoIndex
    std::vector<float> power;          //   all pairs of all records, one record after another
    std::vector<float> lambda_nm;      //   the same, in jobs without a density (foreign writers)

    std::vector<ExtraColumn> extra;  // as the job names them, in its order
};

// Some of a job's extra columns, by their places in its list.
using ExtraSet = std::bitset<kMaxExtraColumns>;
inline const ExtraSet kAllExtra = ~ExtraSet();

// Which columns a reader needs; the others stay empty and cost nothing.
struct ColumnSet {
    bool samples = true;
    bool positions = true;
    bool values = true;  // x,y,z or pairs, power, xi, index, lambda_nm
    bool share = true;
    ExtraSet extra = kAllExtra;
};

enum class Column : std::uint8_t {  // numbers in the file
    kSample = 1,
    kU = 2,
    kV = 3,
    kShare = 4,
    kX = 5,
    kY = 6,
    kZ = 7,
    kPairs = 8,
    kXi = 9,
    kIndex = 10,
    kPower = 11,
    kLambda = 12,
    kFirstExtra = 64,
};

enum class Presence : std::uint8_t {
    kAlways,
    kCamera,
    kXyz,
    kSpectral,
    kDensity,
    kNoDensity
};                                                    // which pages, or jobs, have a column
enum class Rows : std::uint8_t { kRecords, kPairs };  // one value for each
enum class Coding : std::uint8_t {
    kPlain,         // byte planes, or a constant; all that extra columns need
    kSample,        // packed, or on the lattice
    kPosition,      // plain, or left out
    kLuminance,     // sparse or plain
    kCrossed,       // beside the luminance
    kAlongRecords,  // second differences of each record's pairs
};

template <class T>
struct ColumnSpec {
    using Value = T;
    Column number;
    const char* name;
    std::vector<T> Columns::*values;
    bool ColumnSet::*wanted;
    Presence presence = Presence::kAlways;
    Rows rows = Rows::kRecords;
    Coding coding = Coding::kPlain;
};
template <class T>
ColumnSpec(Column, const char*, std::vector<T> Columns::*, bool ColumnSet::*, Presence, Rows = {}, Coding = {}) -> ColumnSpec<T>;

// In the order of a page's table.
inline constexpr std::tuple kColumns{
    ColumnSpec{Column::kSample, "sample", &Columns::sample, &ColumnSet::samples, Presence::kAlways, Rows::kRecords,
               Coding::kSample},
    ColumnSpec{Column::kU, "u", &Columns::u, &ColumnSet::positions, Presence::kAlways, Rows::kRecords, Coding::kPosition},
    ColumnSpec{Column::kV, "v", &Columns::v, &ColumnSet::positions, Presence::kAlways, Rows::kRecords, Coding::kPosition},
    ColumnSpec{Column::kShare, "share", &Columns::share, &ColumnSet::share, Presence::kCamera},
    ColumnSpec{Column::kX, "x", &Columns::x, &ColumnSet::values, Presence::kXyz, Rows::kRecords, Coding::kCrossed},
    ColumnSpec{Column::kY, "y", &Columns::y, &ColumnSet::values, Presence::kXyz, Rows::kRecords, Coding::kLuminance},
    ColumnSpec{Column::kZ, "z", &Columns::z, &ColumnSet::values, Presence::kXyz, Rows::kRecords, Coding::kCrossed},
    ColumnSpec{Column::kPairs, "pairs", &Columns::pairs, &ColumnSet::values, Presence::kSpectral},
    ColumnSpec{Column::kXi, "xi", &Columns::xi, &ColumnSet::values, Presence::kDensity},
    ColumnSpec{Column::kIndex, "index", &Columns::index, &ColumnSet::values, Presence::kDensity},
    ColumnSpec{Column::kPower, "power", &Columns::power, &ColumnSet::values, Presence::kSpectral, Rows::kPairs,
               Coding::kAlongRecords},
    ColumnSpec{Column::kLambda, "lambda", &Columns::lambda_nm, &ColumnSet::values, Presence::kNoDensity, Rows::kPairs,
               Coding::kAlongRecords},
};
inline constexpr std::size_t kColumnCount = std::tuple_size_v<decltype(kColumns)>;

// A column of the table as a type, whose `spec` is a constant.
template <std::size_t i>
struct ColumnAt {
    static constexpr auto spec = std::get<i>(kColumns);
    static constexpr std::size_t place = i;
    using Value = typename decltype(spec)::Value;
};

// Calls f with each ColumnAt of the table, in its order.
template <class F>
constexpr void for_each_column(F&& f) {
    [&]<std::size_t... i>(std::index_sequence<i...>) { (f(ColumnAt<i>{}), ...); }
    (std::make_index_sequence<kColumnCount>());
}

constexpr bool is_present(Presence presence, RecordKind kind, bool density, RecordClass record_class) {
    const bool spectral = kind == RecordKind::kSpectral;
    switch (presence) {
        case Presence::kAlways:
            return true;
        case Presence::kCamera:
            return record_class == RecordClass::kCamera;
        case Presence::kXyz:
            return !spectral;
        case Presence::kSpectral:
            return spectral;
        case Presence::kDensity:
            return spectral && density;
        case Presence::kNoDensity:
            return spectral && !density;
    }
    return false;
}

// Elements of a column's vector for each of its rows: one value, or the bytes of an extra column's.
struct Shape {
    Rows rows = Rows::kRecords;
    std::size_t width = 1;
};

// Calls f(shape, values of `first`, values of each of `others`) for the columns of the table and the extra ones, which all have
// alike.
template <class F, class First, class... Others>
void for_each_values(F&& f, First& first, Others&... others) {
    for_each_column([&](auto column) {
        constexpr auto spec = column.spec;
        f(Shape{spec.rows}, first.*spec.values, others.*spec.values...);
    });
    for (std::size_t i = 0; i < first.extra.size(); ++i)
        f(Shape{Rows::kRecords, width(first.extra[i].type)}, first.extra[i].values, others.extra[i].values...);
}

// Copies row `from[row]` of a column, `width` elements wide, to `to`.
template <class T>
void copy_row(const T* from, std::size_t row, std::size_t width, T* to) {
    if constexpr (std::is_same_v<T, std::byte>) {
        for (std::size_t i = 0; i < width; ++i) to[i] = from[row * width + i];
    } else {
        *to = from[row];
    }
}

}  // namespace latent::sampledb
