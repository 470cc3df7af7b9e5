#include "sampledb/read/byte_source.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/url.h"
#include "sampledb/read/remote_source.h"

namespace latent::sampledb {

Status copy_bytes(const ByteSource& source, std::uint64_t source_offset, File& file, std::uint64_t offset, std::uint64_t length) {
    if (source.file() != nullptr) return file.copy_from(*source.file(), source_offset, offset, length);
    constexpr std::uint64_t kPiece = std::uint64_t{1} << 20;
    Bytes piece(std::min(length, kPiece));
    for (std::uint64_t done = 0; done < length;) {
        const std::span<std::byte> bytes = std::span(piece).first(std::min(length - done, kPiece));
        if (Status s = source.read(source_offset + done, bytes); !s) return s;
        if (Status s = file.write_all(offset + done, bytes); !s) return s;
        done += bytes.size();
    }
    return {};
}

Result<std::shared_ptr<const ByteSource>> open_source(const std::filesystem::path& path) {
    if (is_url(path)) return open_remote(path);
    Result<FileSource> file = FileSource::open(path);
    if (!file) return file.error();
    return std::make_shared<const FileSource>(std::move(*file));
}

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
