#include "sampledb/read/byte_source.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace latent::sampledb {

Result<FileSource> FileSource::open(const std::filesystem::path& path) {
    Result<File> file = File::open_read(path);
    if (!file) return file.error();
    const Result<std::uint64_t> size = file->size();
    if (!size) return size.error();
    return FileSource(std::move(*file), *size);
}

Status FileSource::read(std::uint64_t offset, std::span<std::byte> into) const { return file_.read_exact(offset, into); }

std::uint64_t FileSource::end_of_hole(std::uint64_t offset) const {
    const off_t data = ::lseek(file_.descriptor(), static_cast<off_t>(offset), SEEK_DATA);
    if (data < 0) return errno == ENXIO ? std::max(offset, size_) : offset;  // none behind it; or not known here
    return std::min(static_cast<std::uint64_t>(data), std::max(offset, size_));
}

Status MemorySource::read(std::uint64_t offset, std::span<std::byte> into) const {
    if (offset > bytes_.size() || into.size() > bytes_.size() - offset) {
        return Error{ErrorCode::kTruncated, fmt::format("{}: ends at byte {}", name_, bytes_.size())};
    }
    if (!into.empty()) std::memcpy(into.data(), bytes_.data() + offset, into.size());
    return {};
}

}  // namespace latent::sampledb
