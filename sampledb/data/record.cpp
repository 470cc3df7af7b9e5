#include "sampledb/data/record.h"

namespace latent::sampledb {

std::size_t width(ColumnType type) {
    switch (type) {
        case ColumnType::kU8:
            return 1;
        case ColumnType::kU16:
            return 2;
        case ColumnType::kU32:
        case ColumnType::kF32:
            return 4;
        case ColumnType::kU64:
        case ColumnType::kF64:
            return 8;
    }
    return 0;
}

void Records::clear() {
    sample.clear(), record_class.clear(), u.clear(), v.clear(), share.clear();
    x.clear(), y.clear(), z.clear();
    pairs.clear(), xi.clear(), index.clear(), power.clear(), lambda_nm.clear();
    for (ExtraColumn& column : extra) column.values.clear();
}

Records Records::without_rows() const {
    Records none;
    for (const ExtraColumn& column : extra) none.extra.push_back({column.name, column.type, {}});
    return none;
}

void Records::append(const Records& from, std::size_t row, std::size_t first_pair) {
    const auto take = [row](auto& to, const auto& column) {
        if (!column.empty()) to.push_back(column[row]);
    };
    take(sample, from.sample), take(record_class, from.record_class), take(u, from.u), take(v, from.v), take(share, from.share);
    take(x, from.x), take(y, from.y), take(z, from.z);
    take(pairs, from.pairs), take(xi, from.xi), take(index, from.index);
    const auto take_pairs = [&](auto& to, const auto& column) {
        if (column.empty()) return;
        const auto first = column.begin() + static_cast<std::ptrdiff_t>(first_pair);
        to.insert(to.end(), first, first + from.pairs[row]);
    };
    take_pairs(power, from.power), take_pairs(lambda_nm, from.lambda_nm);
    for (std::size_t i = 0; i < from.extra.size(); ++i) {
        const std::size_t bytes = width(from.extra[i].type);
        const auto first = from.extra[i].values.begin() + static_cast<std::ptrdiff_t>(row * bytes);
        extra[i].values.insert(extra[i].values.end(), first, first + static_cast<std::ptrdiff_t>(bytes));
    }
}

std::uint64_t Records::raw_bytes() const {
    const auto bytes = [](const auto& column) { return std::uint64_t{column.size()} * sizeof(column[0]); };
    std::uint64_t sum = bytes(sample) + bytes(record_class) + bytes(u) + bytes(v) + bytes(share) + bytes(x) + bytes(y) + bytes(z) +
                        bytes(pairs) + bytes(xi) + bytes(index) + bytes(power) + bytes(lambda_nm);
    for (const ExtraColumn& column : extra) sum += column.values.size();
    return sum;
}

}  // namespace latent::sampledb
