// base/small_file.h: files that are read whole, because they are small.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.h"

namespace latent {

// What the file holds. Errors: of reading; kForeign, "PATH: too large for WHAT" above `most` bytes.
Result<std::string> read_small_file(const std::filesystem::path& path, std::uint64_t most, std::string_view what);

}  // namespace latent
