#include "color/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace latent::color {
namespace {

std::vector<std::string_view> fields_of(std::string_view line) {
    constexpr std::string_view kSeparators = ",; \t\r";
    std::vector<std::string_view> fields;
    while (true) {
        const std::size_t begin = line.find_first_not_of(kSeparators);
        if (begin == std::string_view::npos) return fields;
        const std::size_t end = std::min(line.find_first_of(kSeparators, begin), line.size());
        fields.push_back(line.substr(begin, end - begin));
        line.remove_prefix(end);
    }
}

}  // namespace

std::vector<CsvRow> csv_rows(std::string_view text) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // a byte order mark
    std::vector<CsvRow> rows;
    for (int line = 1; !text.empty(); ++line) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view content = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        content = content.substr(0, content.find('#'));
        std::vector<std::string_view> fields = fields_of(content);
        if (!fields.empty()) rows.push_back({line, std::move(fields)});
    }
    return rows;
}

std::optional<double> csv_number(std::string_view field) {
    if (field.starts_with('+')) field.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc{} || end != field.data() + field.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

Error csv_error(int line, std::string what) { return Error{ErrorCode::kCorrupt, std::move(what)}.at(fmt::format("line {}", line)); }

Result<Spectrum> curve_from_csv(std::string_view text, std::string_view abscissa, std::string_view example) {
    std::vector<double> nm, factor;
    bool first = true;
    for (const CsvRow& row : csv_rows(text)) {
        if (std::exchange(first, false) && !csv_number(row.fields[0])) continue;  // the line of column names
        const auto x = csv_number(row.fields[0]), y = csv_number(row.fields.back());
        if (row.fields.size() != 2 || !x || !y)
            return csv_error(row.line, fmt::format("not a {} and a factor, as in {}", abscissa, example));
        if (*y < 0) return csv_error(row.line, fmt::format("a factor cannot be negative: {}", row.fields[1]));
        if (!nm.empty() && *x <= nm.back())
            return csv_error(row.line, fmt::format("{}s must increase, but {} follows {}; sort the rows", abscissa, *x, nm.back()));
        nm.push_back(*x);
        factor.push_back(*y);
    }
    if (nm.empty()) return Error{ErrorCode::kCorrupt, fmt::format("has no rows of a {} and a factor", abscissa)};
    return Spectrum::from_samples(std::move(nm), std::move(factor), Outside::kClamped);
}

}  // namespace latent::color
