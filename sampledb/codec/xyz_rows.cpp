#include "sampledb/codec/xyz_rows.h"

#include "sampledb/codec/four_by_four.h"

namespace latent::sampledb {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr four::Tag kFour;

constexpr std::size_t kAhead = 16;  // rows on their way from memory while some are copied

// A row is sample, u and v, and behind them share, x, y and z.
constexpr std::size_t offset_of(Column column) { return row_offset(RecordKind::kXyz, column); }
static_assert(offset_of(Column::kSample) == 0 && offset_of(Column::kU) == 8 && offset_of(Column::kV) == 12);
static_assert(offset_of(Column::kShare) == 16 && offset_of(Column::kX) == 20 && offset_of(Column::kY) == 24 &&
              offset_of(Column::kZ) == 28);

void load_row(const Columns& columns, std::size_t at, SorterRow& row) {
    for_each_column([&](auto column) {
        constexpr auto spec = column.spec;
        if constexpr (is_present(spec.presence, RecordKind::kXyz, false, RecordClass::kCamera))
            row.set(offset_of(spec.number), (columns.*spec.values)[at]);
    });
}

void store_row(const SorterRow& row, Columns& columns, std::size_t at) {
    for_each_column([&](auto column) {
        constexpr auto spec = column.spec;
        if constexpr (is_present(spec.presence, RecordKind::kXyz, false, RecordClass::kCamera))
            (columns.*spec.values)[at] = row.get<typename decltype(column)::Value>(offset_of(spec.number));
    });
}

}  // namespace

// First one half of all rows, then the other: columns tend to begin at the same place of a memory page, and more than four of them
// read in step would push each other out of the cache.
void load_xyz_rows(const Columns& columns, std::size_t first, std::span<SorterRow> rows) {
    const std::size_t whole = rows.size() - rows.size() % 4;
    for (std::size_t i = 0; i < whole; i += 4) {
        const std::uint64_t* const sample = &columns.sample[first + i];
        const Four u = load(&columns.u[first + i]), v = load(&columns.v[first + i]);
        const Four low = hn::InterleaveLower(kFour, u, v), high = hn::InterleaveUpper(kFour, u, v);
        const Four a = load(sample), b = load(sample + 2);
        store(lower(a, low), &rows[i].bytes[0]);
        store(upper(a, low), &rows[i + 1].bytes[0]);
        store(lower(b, high), &rows[i + 2].bytes[0]);
        store(upper(b, high), &rows[i + 3].bytes[0]);
    }
    for (std::size_t i = 0; i < whole; i += 4) {
        const std::size_t at = first + i;
        const FourByFour four =
            FourByFour{load(&columns.share[at]), load(&columns.x[at]), load(&columns.y[at]), load(&columns.z[at])}.transposed();
        store(four.a, &rows[i].bytes[16]);
        store(four.b, &rows[i + 1].bytes[16]);
        store(four.c, &rows[i + 2].bytes[16]);
        store(four.d, &rows[i + 3].bytes[16]);
    }
    for (std::size_t i = whole; i < rows.size(); ++i) load_row(columns, first + i, rows[i]);
}

bool gather_xyz_rows(const SorterRow* rows, std::span<const std::uint32_t> places, Columns& columns) {
    const std::size_t n = places.size(), whole = n - n % 4;
    const Four one = hn::BitCast(kFour, hn::Set(hn::FixedTag<float, 4>(), 1.0f));
    Four different = hn::Zero(kFour);
    for (std::size_t i = 0; i < whole; i += 4) {
        if (i + kAhead + 4 <= n) {
            for (std::size_t k = 0; k < 4; ++k) __builtin_prefetch(&rows[places[i + kAhead + k]]);
        }
        const SorterRow &a = rows[places[i]], &b = rows[places[i + 1]], &c = rows[places[i + 2]], &d = rows[places[i + 3]];
        const Four a0 = load(&a.bytes[0]), b0 = load(&b.bytes[0]), c0 = load(&c.bytes[0]), d0 = load(&d.bytes[0]);
        store(lower(a0, b0), &columns.sample[i]);
        store(lower(c0, d0), &columns.sample[i + 2]);
        const Four uv_low = upper(a0, b0), uv_high = upper(c0, d0);  // u v u v
        store(hn::ConcatEven(kFour, uv_high, uv_low), &columns.u[i]);
        store(hn::ConcatOdd(kFour, uv_high, uv_low), &columns.v[i]);
        const FourByFour four =
            FourByFour{load(&a.bytes[16]), load(&b.bytes[16]), load(&c.bytes[16]), load(&d.bytes[16])}.transposed();
        store(four.a, &columns.share[i]);
        store(four.b, &columns.x[i]);
        store(four.c, &columns.y[i]);
        store(four.d, &columns.z[i]);
        different = hn::Or(different, hn::Xor(four.a, one));
    }
    bool unit_share = hn::AllTrue(kFour, hn::Eq(different, hn::Zero(kFour)));
    for (std::size_t i = whole; i < n; ++i) {
        store_row(rows[places[i]], columns, i);
        unit_share &= columns.share[i] == 1;
    }
    return unit_share;
}

}  // namespace latent::sampledb
