#include "tools/inspect/text_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <type_traits>

#include "base/bytes.h"
#include "base/json.h"
#include "base/printable.h"
#include "sampledb/data/page.h"

namespace latent::inspect {

using namespace sampledb;

namespace {

// A float in as few digits as bring it back exactly; JSON has no NaN or infinity: they become null.
template <class T>
void put_value(std::string& line, T value, bool json) {
    if constexpr (std::is_floating_point_v<T>) {
        if (json && !std::isfinite(value)) {
            line += "null";
            return;
        }
    }
    fmt::format_to(std::back_inserter(line), "{}", value);
}

void put_extra(std::string& line, const ExtraColumn& column, std::size_t row, bool json) {
    const std::byte* at = column.values.data() + row * width(column.type);
    switch (column.type) {
        case ColumnType::kU8:
            return put_value(line, load_le<std::uint8_t>(at), json);
        case ColumnType::kU16:
            return put_value(line, load_le<std::uint16_t>(at), json);
        case ColumnType::kU32:
            return put_value(line, load_le<std::uint32_t>(at), json);
        case ColumnType::kU64:
            return put_value(line, load_le<std::uint64_t>(at), json);
        case ColumnType::kF32:
            return put_value(line, load_le<float>(at), json);
        case ColumnType::kF64:
            return put_value(line, load_le<double>(at), json);
    }
}

// A name as a field of CSV [RFC4180], without what would steer a terminal.
std::string csv_field(const std::string& name) {
    const std::string shown = printable_line(name);
    if (shown.find_first_of(",\"") == std::string::npos) return shown;
    std::string field = "\"";
    for (const char c : shown) field += c == '"' ? "\"\"" : std::string(1, c);
    return field + '"';
}

// Columns that say how the wavelengths of a record are stored: its pairs are printed in their place.
constexpr bool is_spectral(Presence presence) {
    return presence == Presence::kSpectral || presence == Presence::kDensity || presence == Presence::kNoDensity;
}

std::span<const float> powers(const Page& page, std::size_t row) {
    return {page.power.data() + page.first_pair[row], page.pairs[row]};
}

}  // namespace

TextRows::TextRows(const Job& job, CatFormat format) : job_(job), json_(format == CatFormat::kJsonLines), lambda_(kMaxPairs) {
    for_each_column([&](auto column) {
        constexpr auto spec = column.spec;
        if (!has_column(job, RecordClass::kCamera, spec.presence)) return;
        if constexpr (spec.number == Column::kPairs) {
            names_.insert(names_.end(), {"lambda_nm", "power"});
        } else if constexpr (!is_spectral(spec.presence)) {
            names_.push_back(spec.name);
        }
        if constexpr (spec.number == Column::kSample) names_.push_back("class");
    });
    for (const ExtraColumnSpec& column : job.extra) {
        std::string name = column.name;
        while (std::ranges::find(names_, name) != names_.end()) name.insert(0, "extra.");
        names_.push_back(std::move(name));
    }
    for (const std::string& name : names_) {
        const char* const before = before_.empty() ? (json_ ? "{" : "") : ",";
        before_.push_back(json_ ? fmt::format("{}{}:", before, json_text(nlohmann::json(name), -1)) : before);
    }
    if (json_) return;
    for (const std::string& name : names_) heading_ += (heading_.empty() ? "" : ",") + csv_field(name);
    heading_ += '\n';
}

void TextRows::put(std::string& line, const Page& page, std::size_t row) {
    auto before = before_.begin();
    const auto next = [&]() -> std::string& { return line += *before++; };
    for_each_column([&](auto column) {
        constexpr auto spec = column.spec;
        if (!has_column(job_, RecordClass::kCamera, spec.presence)) return;
        if constexpr (spec.number == Column::kPairs) {
            put_list(next(), wavelengths(page, row));
            put_list(next(), powers(page, row));
        } else if constexpr (spec.number == Column::kShare) {
            put_value(next(), share_of(page, row), json_);
        } else if constexpr (spec.coding == Coding::kPosition) {
            put_value(next(), (page.*spec.values)[row] * 0x1p-32, json_);
        } else if constexpr (!is_spectral(spec.presence)) {
            put_value(next(), (page.*spec.values)[row], json_);
        }
        if constexpr (spec.number == Column::kSample) put_class(next(), page.record_class);
    });
    for (const ExtraColumn& column : page.extra) put_extra(next(), column, row, json_);
    line += json_ ? "}\n" : "\n";
}

void TextRows::put_class(std::string& line, RecordClass record_class) const {
    const char* const name = record_class == RecordClass::kCamera ? "camera" : "light";
    line += json_ ? fmt::format("\"{}\"", name) : name;
}

void TextRows::put_list(std::string& line, std::span<const float> values) const {
    if (json_) line += '[';
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (i > 0) line += json_ ? ',' : ' ';
        put_value(line, values[i], json_);
    }
    if (json_) line += ']';
}

std::span<const float> TextRows::wavelengths(const Page& page, std::size_t row) {
    const std::span<float> lambda = std::span(lambda_).first(page.pairs[row]);
    wavelengths_of(job_.density, job_.batch, page, row, lambda);
    return lambda;
}

}  // namespace latent::inspect
