// Observers from the text of a table: Observer::from_csv.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "color/csv.h"
#include "color/observer.h"
#include "color/power_of_ten.h"

namespace latent::color {
namespace {

struct CsvTable {
    ResponseTable responses;
    std::vector<int> line;  // where each row stands in the text
    std::size_t columns = 0;
    std::vector<bool> logarithmic;  // by column
};

Status read_row(const std::vector<std::string_view>& fields, int line, CsvTable& table) {
    if (fields.size() != table.columns) {
        return csv_error(line, fmt::format("{} columns, but the lines above have {}", fields.size(), table.columns));
    }
    std::array<double, 4> value{};
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const std::optional<double> read = csv_number(fields[i]);
        if (!read) return csv_error(line, fmt::format("\"{}\" is not a finite number", fields[i]));
        value[i] = table.logarithmic[i] ? power_of_ten(*read) : *read;
        if (i > 0 && value[i] < 0) return csv_error(line, fmt::format("a response cannot be negative: {}", fields[i]));
        if (i > 0 && !std::isfinite(value[i])) return csv_error(line, fmt::format("a response cannot be 10^{}", fields[i]));
    }
    if (!table.responses.lambda_nm.empty() && value[0] <= table.responses.lambda_nm.back()) {
        return csv_error(line, fmt::format("wavelengths must increase, but {} nm follows {} nm; sort the rows", value[0],
                                           table.responses.lambda_nm.back()));
    }
    if (value[0] < 10 || value[0] > 100'000) {
        return csv_error(line, fmt::format("{} is not a wavelength of light in nm", value[0]));
    }
    table.responses.lambda_nm.push_back(value[0]);
    table.responses.response.push_back(table.columns == 4 ? std::array{value[1], value[2], value[3]}
                                                          : std::array{value[1], value[1], value[1]});
    return {};
}

// Rows so far apart, or a table that ends so early, would pass as a sensor that sees nothing there, or something straight.
constexpr double kFrom = 400, kTo = 700, kWidestGap = 30;
constexpr double kBeginsBy = 420, kEndsFrom = 660, kSmallEnd = 0.1;

Status check_coverage(const CsvTable& table) {
    const std::vector<double>& nm = table.responses.lambda_nm;
    const auto largest_of = [&](std::size_t row) { return std::ranges::max(table.responses.response[row]); };
    double peak = 0;
    for (std::size_t row = 0; row < nm.size(); ++row) peak = std::max(peak, largest_of(row));
    for (std::size_t row = 1; row < nm.size(); ++row) {
        const bool inside = nm[row] > kFrom && nm[row - 1] < kTo, dark = largest_of(row - 1) + largest_of(row) == 0;
        if (!inside || dark || nm[row] - nm[row - 1] <= kWidestGap) continue;
        return csv_error(table.line[row],
                         fmt::format("no rows between {} and {} nm; between {} and {} nm they may be at most {} nm apart",
                                     nm[row - 1], nm[row], kFrom, kTo, kWidestGap));
    }
    const auto cut = [&](std::size_t row, const char* where) {
        return csv_error(table.line[row], fmt::format("the table {} at {} nm, where the response is {:.0f} % of the largest; "
                                                      "add rows, or one row of zeros if there is no response beyond",
                                                      where, nm[row], 100 * largest_of(row) / peak));
    };
    if (nm.front() > kBeginsBy && largest_of(0) > kSmallEnd * peak) return cut(0, "begins");
    if (nm.back() < kEndsFrom && largest_of(nm.size() - 1) > kSmallEnd * peak) return cut(nm.size() - 1, "ends");
    return {};
}

Result<CsvTable> read_table(std::string_view text) {
    CsvTable table;
    for (const auto& [line, fields] : csv_rows(text)) {
        const bool first = table.columns == 0;
        if (first) {
            if (fields.size() != 2 && fields.size() != 4) {
                return csv_error(
                    line,
                    fmt::format("{} columns; an observer has the wavelength [nm] and 3 responses, or 1 for black-and-white film",
                                fields.size()));
            }
            table.columns = fields.size();
            if (table.columns == 2) table.responses.kind = ObserverKind::kFilm;
            table.logarithmic.resize(fields.size());
            if (!csv_number(fields[0])) {  // the line of column names
                for (std::size_t i = 1; i < fields.size(); ++i) table.logarithmic[i] = fields[i].starts_with("log10");
                if (fields.size() == 4 && fields[1] == "r" && fields[2] == "g" && fields[3] == "b")
                    table.responses.kind = ObserverKind::kCamera;
                continue;
            }
        }
        if (Status s = read_row(fields, line, table); !s) return s.error();
        table.line.push_back(line);
    }
    if (table.responses.lambda_nm.size() < 2) return Error{ErrorCode::kCorrupt, "an observer needs at least two lines of numbers"};
    if (Status s = check_coverage(table); !s) return s.error();
    return table;
}

}  // namespace

Result<Observer> Observer::from_csv(std::string_view text, std::string name) {
    Result<CsvTable> table = read_table(text);
    if (!table) return table.error();
    table->responses.name = std::move(name);
    return from_table(std::move(table->responses));
}

}  // namespace latent::color
