// base/parse.h: numbers as people write them on command lines: one grammar for every option of every tool (README.md, "The tools in
// five lines").
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.h"

namespace latent {

// The error "'x' is not a depth (try 12)", for an argument `text` and `what` it should be. Code kUsage.
Error is_not(std::string_view text, std::string_view what);

// A count of things: digits, then nothing or a unit: K, M, G, T are powers of 1000, Ki, Mi, Gi, Ti powers of 1024, in either case.
// With a unit there may be a fraction, and the result is rounded: "1.07G" is 1070000000. Or a power of ten, "1e6", up to 2^53.
// Errors: kUsage (a sign, too large, not whole).
Result<std::uint64_t> parse_count(std::string_view text);

// Bytes: as above, but K, M, G, T are powers of 1024 too, as everywhere where memory is measured: "512M" is 536870912.
Result<std::uint64_t> parse_size(std::string_view text);

// A finite real number, with or without a sign, an exponent, or one of the units of parse_count. Errors: kUsage.
Result<double> parse_number(std::string_view text);

// Seconds, above 0: "90", "90s", "10m", "1.5h", "2d", "1h30m". Errors: kUsage.
Result<double> parse_duration(std::string_view text);

// Two counts with `separator` between them, as in "0:64K", "3/4", "1920x1080"; nothing if the text is anything else.
std::optional<std::pair<std::uint64_t, std::uint64_t>> parse_pair(std::string_view text, char separator);

// Numbers with commas between them, as in "0.4,0.4,0.6,0.6"; nothing if the text is anything else.
std::optional<std::vector<double>> parse_numbers(std::string_view text);

// "X0,Y0,X1,Y1": pixels from (X0, Y0) to (X1, Y1), ends exclusive. Errors: kUsage (also X1 <= X0, Y1 <= Y0, not below 2^31).
Result<std::array<std::int32_t, 4>> parse_crop(std::string_view text);

}  // namespace latent
