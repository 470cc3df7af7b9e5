// color/csv.h: tables of numbers as text: what observers and curves are read from. docs/color.md, "Observers".
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "color/spectrum.h"

namespace latent::color {

struct CsvRow {
    int line;
    std::vector<std::string_view> fields;  // parts of the text; at least one
};
// Fields stand between commas, semicolons, tabs and blanks; `#` starts a comment; a byte order mark and empty lines are skipped.
std::vector<CsvRow> csv_rows(std::string_view text);

// A finite number, with or without a sign.
std::optional<double> csv_number(std::string_view field);

// "line 12: WHAT".
Error csv_error(int line, std::string what);

// Rows of wavelength [nm] and factor; one line of column names may come first. Wavelengths strictly increase, factors are not
// negative; the end values go on for ever. `abscissa` and `example` are for messages about tables of something else. Errors:
// kCorrupt, "line 12: ..."; kOutOfRange.
Result<Spectrum> curve_from_csv(std::string_view text, std::string_view abscissa = "wavelength",
                                std::string_view example = "550,0.8");

}  // namespace latent::color
