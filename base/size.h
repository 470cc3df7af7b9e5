// base/size.h: sizes, times and counts as people read them. How they write them: base/parse.h.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace latent {

// 536870912 -> "512.0 MiB".
std::string format_size(std::uint64_t bytes);

// 93784 s -> "26h03m"; 75 s -> "1m15s"; 4.2 s -> "4.2s".
std::string format_duration(double seconds);

// 523412 -> "523 K"; 1351 -> "1.35 K"; 12.3456 -> "12.3". Three digits, powers of 1000.
std::string format_count(double count);

// "1 record", "0 records", "3 records".
std::string counted(std::uint64_t count, std::string_view noun);

// "1 sample per pixel", "12.3 samples per pixel", "1.35 K samples per pixel".
std::string format_samples_per_pixel(double count);

}  // namespace latent
