#include "base/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>

#include "base/hidden_name.h"

namespace latent {

namespace {

constexpr std::size_t kMaxTransfer = std::size_t{1} << 30;  // copy_file_range and pwrite stop near 2 GiB; stay well below

int open_retrying(const char* path, int flags, mode_t mode = 0) {
    int fd;
    do fd = ::open(path, flags | O_CLOEXEC, mode);
    while (fd < 0 && errno == EINTR);
    return fd;
}

// Errors of copy_file_range after which copying goes on through memory. EIO is one: only there shows which file is to blame.
bool kernel_copy_unavailable(int error) {
    return error == EXDEV || error == EINVAL || error == ENOSYS || error == EOPNOTSUPP || error == EPERM || error == EBADF ||
           error == EIO;
}

}  // namespace

File::File(File&& other) noexcept : fd_(std::exchange(other.fd_, -1)), path_(std::move(other.path_)) {}

File& File::operator=(File&& other) noexcept {
    std::swap(fd_, other.fd_);
    std::swap(path_, other.path_);
    return *this;
}

File::~File() {
    if (fd_ >= 0) ::close(fd_);
}

// Inputs are regular files. O_NONBLOCK means nothing to these; a pipe without a writer would be waited for without it.
Result<File> File::open_read(const std::filesystem::path& path) {
    if (path.empty()) return Error{ErrorCode::kNotFound, "empty file name"};
    const Error irregular{ErrorCode::kForeign, path.string() + ": not a regular file"};
    const int fd = open_retrying(path.c_str(), O_RDONLY | O_NONBLOCK);
    if (fd < 0 && errno == ENXIO) return irregular;  // a socket
    if (fd < 0 && errno == ELOOP) return Error{ErrorCode::kForeign, path.string() + ": a symbolic link that leads back to itself"};
    if (fd < 0) return error_from_errno(errno, path.string(), "cannot open");
    File file(fd, path);
    struct stat info;
    if (::fstat(fd, &info) != 0) return error_from_errno(errno, path.string(), "cannot read its attributes");
    if (S_ISDIR(info.st_mode)) return Error{ErrorCode::kForeign, path.string() + ": is a folder, not a file"};
    if (!S_ISREG(info.st_mode)) return irregular;
    return file;
}

Result<File> File::create_exclusive(const std::filesystem::path& path) {
    const int fd = open_retrying(path.c_str(), O_RDWR | O_CREAT | O_EXCL, 0666);
    if (fd < 0) return error_from_errno(errno, path.string(), "cannot create");
    return File(fd, path);
}

Result<File> File::create_unnamed(const std::filesystem::path& folder) {
    int fd = open_retrying(folder.c_str(), O_RDWR | O_TMPFILE, 0600);
    const std::string place = folder.string() + "/(temporary file)";
    if (fd >= 0) return File(fd, place);
    if (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)
        return error_from_errno(errno, folder.string(), "cannot create a temporary file");
    const TemporaryPath name(folder / fmt::format(".latent-{}.tmp", make_nonce()));  // until it is open
    fd = open_retrying(name.path().c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
    if (fd < 0) return error_from_errno(errno, folder.string(), "cannot create a temporary file");
    return File(fd, place);
}

Result<File> File::create_in_memory() {
    const int fd = ::memfd_create("latent", MFD_CLOEXEC);
    if (fd < 0) return error_from_errno(errno, "(memory)", "cannot create a file");
    return File(fd, "(memory)");
}

Result<std::uint64_t> File::size() const {
    struct stat info;
    if (::fstat(fd_, &info) != 0) return error_from_errno(errno, path_.string(), "cannot read its size");
    return static_cast<std::uint64_t>(info.st_size);
}

Result<std::size_t> File::read_some(std::uint64_t offset, std::span<std::byte> into) const {
    std::size_t done = 0;
    while (done < into.size()) {
        const std::size_t ask = std::min(into.size() - done, kMaxTransfer);
        const ssize_t got = ::pread(fd_, into.data() + done, ask, static_cast<off_t>(offset + done));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return error_from_errno(errno, path_.string(), fmt::format("cannot read at byte {}", offset + done));
        if (got == 0) break;
        done += static_cast<std::size_t>(got);
    }
    return done;
}

Status File::read_exact(std::uint64_t offset, std::span<std::byte> into) const {
    const Result<std::size_t> got = read_some(offset, into);
    if (!got) return got.error();
    if (*got < into.size()) {
        return Error{ErrorCode::kTruncated, fmt::format("{}: ends at byte {}, {} bytes before the end of the block at byte {}",
                                                        path_.string(), offset + *got, into.size() - *got, offset)};
    }
    return {};
}

void File::expect_scattered_reads() const { ::posix_fadvise(fd_, 0, 0, POSIX_FADV_RANDOM); }

void File::will_read(std::uint64_t offset, std::uint64_t length) const {
    ::posix_fadvise(fd_, static_cast<off_t>(offset), static_cast<off_t>(length), POSIX_FADV_WILLNEED);
}

Status File::write_all(std::uint64_t offset, ByteSpan bytes) {
    std::size_t done = 0;
    while (done < bytes.size()) {
        const std::size_t ask = std::min(bytes.size() - done, kMaxTransfer);
        const ssize_t put = ::pwrite(fd_, bytes.data() + done, ask, static_cast<off_t>(offset + done));
        if (put < 0 && errno == EINTR) continue;
        if (put < 0) return error_from_errno(errno, path_.string(), "cannot write");
        if (put == 0) return Error{ErrorCode::kIo, path_.string() + ": cannot write: the system wrote nothing and gave no reason"};
        done += static_cast<std::size_t>(put);
    }
    return {};
}

Status File::copy_from(const File& source, std::uint64_t source_offset, std::uint64_t offset, std::uint64_t length) {
    std::uint64_t done = 0;
    while (done < length) {
        off_t from = static_cast<off_t>(source_offset + done);
        off_t to = static_cast<off_t>(offset + done);
        const ssize_t copied =
            ::copy_file_range(source.fd_, &from, fd_, &to, std::min<std::uint64_t>(length - done, kMaxTransfer), 0);
        if (copied < 0 && errno == EINTR) continue;
        if (copied < 0 && !kernel_copy_unavailable(errno)) return error_from_errno(errno, path_.string(), "cannot write");
        if (copied <= 0) break;  // go on through memory from here
        done += static_cast<std::uint64_t>(copied);
    }
    Bytes buffer(std::min<std::uint64_t>(length - done, std::uint64_t{4} << 20));
    while (done < length) {
        const std::span<std::byte> piece(buffer.data(), std::min<std::uint64_t>(buffer.size(), length - done));
        if (Status s = source.read_exact(source_offset + done, piece); !s) return s;
        if (Status s = write_all(offset + done, piece); !s) return s;
        done += piece.size();
    }
    return {};
}

void File::begin_writeback(std::uint64_t offset, std::uint64_t length) {
    ::sync_file_range(fd_, static_cast<off_t>(offset), static_cast<off_t>(length), SYNC_FILE_RANGE_WRITE);
}

Status File::truncate(std::uint64_t size) {
    int failed;
    do failed = ::ftruncate(fd_, static_cast<off_t>(size));
    while (failed != 0 && errno == EINTR);
    return failed == 0 ? Status{} : error_from_errno(errno, path_.string(), "cannot truncate");
}

Status File::sync_data() {
    if (::fdatasync(fd_) != 0 && errno != EINVAL && errno != EROFS) return error_from_errno(errno, path_.string(), "cannot sync");
    return {};
}

Status File::close() {
    const int fd = std::exchange(fd_, -1);
    if (fd >= 0 && ::close(fd) != 0 && errno != EINTR) return error_from_errno(errno, path_.string(), "cannot close");
    return {};
}

Result<OutputFile> OutputFile::create(const std::filesystem::path& path, bool replace) {
    remove_abandoned(path);
    std::error_code ignored;
    if (!replace && std::filesystem::exists(std::filesystem::symlink_status(path, ignored))) {
        return Error{ErrorCode::kExists, path.string() + ": already exists; use --force to replace it"};
    }
    if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored)) {
        return Error{ErrorCode::kExists, path.string() + ": is a folder or a device; only files are replaced"};
    }
    OutputFile out;
    out.path_ = path;
    out.replace_ = replace;
    if (::access("/proc/self/fd", X_OK) == 0)  // by which a file without a name gets one
        out.file_ = File(open_retrying(folder_of(path).c_str(), O_RDWR | O_TMPFILE, 0666), path);
    while (!out.file_.is_open()) {
        out.temporary_ = TemporaryPath(hidden_name(path));
        out.file_ = File(open_retrying(out.temporary_.path().c_str(), O_RDWR | O_CREAT | O_EXCL, 0666), path);
        if (!out.file_.is_open()) return error_from_errno(errno, path.string(), "cannot create");
        const int fd = out.file_.descriptor();
        if (!lock_hidden(fd) || !is_named(fd, out.temporary_.path())) out.file_ = File();
    }
    if (out.temporary_.empty()) lock_hidden(out.file_.descriptor());  // before it gets a name
    return out;
}

Status OutputFile::publish() {
    if (Status s = file_.sync_data(); !s) return s;
    const auto cannot = [&] { return error_from_errno(errno, path_.string(), "cannot name the finished file"); };
    if (temporary_.empty()) {
        const std::string self = fmt::format("/proc/self/fd/{}", file_.descriptor());
        if (replace_) temporary_ = TemporaryPath(hidden_name(path_));  // only a file with a name can be renamed over another
        const std::filesystem::path& name = replace_ ? temporary_.path() : path_;
        if (::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0) return cannot();
    } else if (!replace_) {
        if (Status s = name_without_replacing(temporary_.path(), path_); !s) return s;
    }
    if (replace_ && ::rename(temporary_.path().c_str(), path_.c_str()) != 0) return cannot();
    if (Status s = file_.close(); !s) return s;
    if (Status s = sync_folder(folder_of(path_)); !s) {
        return Error{s.error().code, fmt::format("{}: complete and in place, but {}", path_.string(), s.error().message)};
    }
    return {};
}

Status name_without_replacing(const std::filesystem::path& from, const std::filesystem::path& to) {
    int failed = ::link(from.c_str(), to.c_str());
    if (failed != 0 && (errno == EPERM || errno == EOPNOTSUPP || errno == ENOSYS)) {
        errno = rename_without_replacing(from, to);
        failed = errno;
    }
    if (failed != 0) return error_from_errno(errno, to.string(), "cannot name the finished file");
    return {};
}

int rename_without_replacing(const std::filesystem::path& from, const std::filesystem::path& to) {
    if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
    if (errno != EINVAL && errno != ENOSYS && errno != EOPNOTSUPP) return errno;
    std::error_code ignored;
    if (std::filesystem::exists(std::filesystem::symlink_status(to, ignored))) return EEXIST;
    return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

Status sync_folder(const std::filesystem::path& folder) {
    const int fd = open_retrying(folder.c_str(), O_RDONLY | O_DIRECTORY);
    if (fd < 0) return error_from_errno(errno, folder.string(), "cannot open");
    const int failed = ::fsync(fd);
    const int error = errno;
    ::close(fd);
    if (failed != 0 && error != EINVAL && error != EROFS) return error_from_errno(error, folder.string(), "cannot sync");
    return {};
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
    return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

std::optional<std::uint64_t> free_space(const std::filesystem::path& path, bool replace) {
    std::error_code error;
    const std::filesystem::space_info space = std::filesystem::space(folder_of(path), error);
    if (error) return std::nullopt;
    const std::uint64_t replaced = replace ? std::filesystem::file_size(path, error) : 0;
    return error ? space.available : space.available + replaced;
}

std::string make_nonce() {
    std::uint64_t bits = 0;
    while (::getrandom(&bits, sizeof bits, 0) != sizeof bits) {
    }
    return fmt::format("{:016x}", bits);
}

}  // namespace latent
