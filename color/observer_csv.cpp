// Observers from the text of a table: Observer::from_csv.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

#include "color/camera.h"
#include "color/named_spectra.h"
#include "color/observer.h"

namespace latent::color {
namespace {

Error at_line(int line, std::string what) { return Error{ErrorCode::kCorrupt, std::move(what)}.at(fmt::format("line {}", line)); }

// Fields between commas, semicolons, tabs and blanks; empty fields are none.
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

std::optional<double> number(std::string_view field) {
    if (field.starts_with('+')) field.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc{} || end != field.data() + field.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

// 10^x by * and / alone: libm's last bit may depend on the processor, and an observer decides pixels. x = n + f, |f| <= 1/2; the
// series of e^(f ln 10) ends below 1e-17. Infinite where a double is.
double power_of_ten(double x) {
    const double n = std::round(std::clamp(x, -400.0, 400.0)), t = (std::clamp(x, -400.0, 400.0) - n) * std::numbers::ln10;
    double sum = 1, term = 1;
    for (int i = 1; i < 22; ++i) sum += term *= t / i;
    for (int i = 0; i < std::abs(n); ++i) sum = n > 0 ? sum * 10 : sum / 10;
    return sum;
}

struct CsvTable {
    std::vector<double> lambda_nm;
    std::vector<std::array<double, 3>> response;
    std::size_t columns = 0;
    std::vector<bool> logarithmic;  // by column
    bool camera = false;            // its columns are called r, g, b
};

Status read_row(const std::vector<std::string_view>& fields, int line, CsvTable& table) {
    if (fields.size() != table.columns) {
        return at_line(line, fmt::format("{} columns, but the lines above have {}", fields.size(), table.columns));
    }
    std::array<double, 4> value{};
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const std::optional<double> read = number(fields[i]);
        if (!read) return at_line(line, fmt::format("\"{}\" is not a finite number", fields[i]));
        value[i] = table.logarithmic[i] ? power_of_ten(*read) : *read;
        if (i > 0 && (!(value[i] >= 0) || !std::isfinite(value[i])))
            return at_line(line, fmt::format("a response cannot be {}", fields[i]));
    }
    if (!table.lambda_nm.empty() && value[0] <= table.lambda_nm.back()) {
        return at_line(line, fmt::format("wavelengths must increase: {} nm follows {} nm", value[0], table.lambda_nm.back()));
    }
    if (value[0] < 10 || value[0] > 100'000) {
        return at_line(line, fmt::format("{} is not a wavelength of light in nm", value[0]));
    }
    table.lambda_nm.push_back(value[0]);
    table.response.push_back(table.columns == 4 ? std::array{value[1], value[2], value[3]}
                                                : std::array{value[1], value[1], value[1]});
    return {};
}

Result<CsvTable> read_table(std::string_view text) {
    CsvTable table;
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // a byte order mark
    for (int line = 1; !text.empty(); ++line) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view content = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        content = content.substr(0, content.find('#'));
        const std::vector<std::string_view> fields = fields_of(content);
        if (fields.empty()) continue;
        const bool first = table.columns == 0;
        if (first) {
            if (fields.size() != 2 && fields.size() != 4) {
                return at_line(
                    line,
                    fmt::format("{} columns; an observer has the wavelength [nm] and 3 responses, or 1 for black-and-white film",
                                fields.size()));
            }
            table.columns = fields.size();
            table.logarithmic.resize(fields.size());
            if (!number(fields[0])) {  // the line of column names
                for (std::size_t i = 1; i < fields.size(); ++i) table.logarithmic[i] = fields[i].starts_with("log10");
                table.camera = fields.size() == 4 && fields[1] == "r" && fields[2] == "g" && fields[3] == "b";
                continue;
            }
        }
        if (Status s = read_row(fields, line, table); !s) return s.error();
    }
    if (table.lambda_nm.size() < 2) return Error{ErrorCode::kCorrupt, "an observer needs at least two lines of numbers"};
    return table;
}

}  // namespace

Result<Observer> Observer::from_csv(std::string_view text, std::string name) {
    Result<CsvTable> table = read_table(text);
    if (!table) return table.error();
    Observer observer(std::move(name), std::move(table->lambda_nm), std::move(table->response));
    if (table->camera) {
        const Result<Matrix3> xyz = xyz_from_camera({observer.curve(0), observer.curve(1), observer.curve(2)});
        if (!xyz) return xyz.error();
        for (auto& response : observer.response_) response = *xyz * response;
    }
    const double answer = integral_of_product(observer.curve(1), illuminant_d65());
    const double scale = integral_of_product(cie1931().curve(1), illuminant_d65()) / answer;
    if (!(answer > 0) || !std::isfinite(scale)) {
        return Error{ErrorCode::kCorrupt,
                     "the second column of responses (or the only one) has no response to daylight from 360 to 830 nm"};
    }
    for (auto& response : observer.response_) {
        for (double& value : response) value *= scale;
    }
    return observer;
}

}  // namespace latent::color
