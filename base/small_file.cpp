#include "base/small_file.h"

#include <fmt/format.h>

#include <span>

#include "base/file.h"

namespace latent {

Result<std::string> read_small_file(const std::filesystem::path& path, std::uint64_t most, std::string_view what) {
    const Result<File> file = File::open_read(path);
    if (!file) return file.error();
    const Result<std::uint64_t> size = file->size();
    if (!size) return size.error();
    if (*size > most) return Error{ErrorCode::kForeign, fmt::format("{}: too large for {}", path.string(), what)};
    std::string text(*size, '\0');
    if (Status s = file->read_exact(0, std::as_writable_bytes(std::span(text))); !s) return s.error();
    return text;
}

}  // namespace latent
