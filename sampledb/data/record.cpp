#include "sampledb/data/record.h"

namespace latent::sampledb {

void Records::clear() {
    record_class.clear();
    for_each_values([](Shape, auto& values) { values.clear(); }, *this);
}

Records Records::without_rows() const {
    Records none;
    for (const ExtraColumn& column : extra) none.extra.push_back({column.name, column.type, {}});
    return none;
}

void Records::append(const Records& from, std::size_t row, std::size_t first_pair) {
    record_class.push_back(from.record_class[row]);
    const std::size_t pair_count = from.pairs.empty() ? 0 : from.pairs[row];
    const auto take = [&](Shape shape, auto& to, const auto& values) {
        if (values.empty()) return;
        const bool of_pairs = shape.rows == Rows::kPairs;
        const auto first = values.begin() + static_cast<std::ptrdiff_t>(of_pairs ? first_pair : row * shape.width);
        to.insert(to.end(), first, first + static_cast<std::ptrdiff_t>(of_pairs ? pair_count : shape.width));
    };
    for_each_values(take, *this, from);
}

std::uint64_t Records::raw_bytes() const {
    std::uint64_t sum = record_class.size() * sizeof(RecordClass);
    for_each_values([&](Shape, const auto& values) { sum += std::uint64_t{values.size()} * sizeof(values[0]); }, *this);
    return sum;
}

}  // namespace latent::sampledb
