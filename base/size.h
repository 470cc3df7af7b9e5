// base/size.h: sizes and times as people read them. How they write them: base/parse.h.
#pragma once

#include <cstdint>
#include <string>

namespace latent {

// 536870912 -> "512.0 MiB".
std::string format_size(std::uint64_t bytes);

// 93784 s -> "26h03m"; 75 s -> "1m15s"; 4.2 s -> "4.2s".
std::string format_duration(double seconds);

}  // namespace latent
