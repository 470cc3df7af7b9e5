// sampledb/codec/sorter_row.h: a record as the sorter moves it, all fixed columns side by side.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "sampledb/data/columns.h"

namespace latent::sampledb {

// Where column `number` of the table begins in a SorterRow, behind those before it that the kind of the job has.
constexpr std::size_t row_offset(RecordKind kind, Column number) {
    std::size_t offset = 0;
    for_each_column([&](auto column) {
        const bool before = column.spec.number < number && column.spec.rows == Rows::kRecords &&
                            is_present(column.spec.presence, kind, true, RecordClass::kCamera);
        if (before) offset += sizeof(typename decltype(column)::Value);
    });
    return offset;
}

// The columns of a record side by side, half a cache line: fetching a row in sorted order costs one miss, not eight.
struct alignas(32) SorterRow {
    std::array<std::byte, 32> bytes;

    template <class T>
    T get(std::size_t offset) const {
        T value;
        std::memcpy(&value, &bytes[offset], sizeof(T));
        return value;
    }
    template <class T>
    void set(std::size_t offset, T value) {
        std::memcpy(&bytes[offset], &value, sizeof(T));
    }

    static constexpr std::size_t kU = row_offset(RecordKind::kXyz, Column::kU), kV = row_offset(RecordKind::kXyz, Column::kV);
    static constexpr std::size_t kFirstPair = row_offset(RecordKind::kSpectral, Column::kFirstExtra);  // where its pairs begin: u32
    std::uint32_t u() const { return get<std::uint32_t>(kU); }
    std::uint32_t v() const { return get<std::uint32_t>(kV); }
};
static_assert(row_offset(RecordKind::kXyz, Column::kFirstExtra) <= sizeof(SorterRow));
static_assert(SorterRow::kFirstPair + sizeof(std::uint32_t) <= sizeof(SorterRow));

}  // namespace latent::sampledb
