// base/size.h: sizes and numbers as people read and write them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.h"

namespace latent {

// "512M" -> 536870912: digits, then nothing or K, M, G, T (binary, either case). Errors: kUsage (a sign, a fraction, too much).
Result<std::uint64_t> parse_size(std::string_view text);

// "90s", "10m", "2h", "1.5h" or plain seconds -> seconds. Errors: kUsage.
Result<double> parse_duration(std::string_view text);

// 536870912 -> "512.0 MiB".
std::string format_size(std::uint64_t bytes);

// 93784 s -> "26h03m"; 75 s -> "1m15s"; 4.2 s -> "4.2s".
std::string format_duration(double seconds);

}  // namespace latent
