// base/file.h: files as byte ranges, and outputs that appear under their name only when they are complete.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "base/bytes.h"
#include "base/result.h"
#include "base/temporary_path.h"

namespace latent {

// An open file descriptor and the path that errors name. Reads and writes loop over short transfers and EINTR.
class File {
 public:
    File() = default;
    File(File&& other) noexcept;
    File& operator=(File&& other) noexcept;
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    ~File();

    static Result<File> open_read(const std::filesystem::path& path);
    // Errors: kExists if there is a file of that name.
    static Result<File> create_exclusive(const std::filesystem::path& path);
    // Read and write, without a name, in the folder `folder`: gone when closed, whatever ends the process.
    static Result<File> create_unnamed(const std::filesystem::path& folder);

    // The same, in memory: it takes as much as is written, besides what the process holds.
    static Result<File> create_in_memory();

    bool is_open() const { return fd_ >= 0; }
    int descriptor() const { return fd_; }
    const std::filesystem::path& path() const { return path_; }

    Result<std::uint64_t> size() const;
    // Reads exactly `into.size()` bytes at `offset`. Errors: kTruncated if the file ends first.
    Status read_exact(std::uint64_t offset, std::span<std::byte> into) const;
    // Reads up to `into.size()` bytes; returns how many there were before the end of the file.
    Result<std::size_t> read_some(std::uint64_t offset, std::span<std::byte> into) const;
    // Hints, which the system may ignore: reads come here and there, so that none should bring more than it asks for; and these
    // bytes are read soon, so that they may be on their way.
    void expect_scattered_reads() const;
    void will_read(std::uint64_t offset, std::uint64_t length) const;
    Status write_all(std::uint64_t offset, ByteSpan bytes);
    // Copies `length` bytes from another file inside the kernel where it can (copy_file_range), else through memory.
    // File systems that can let both files share what is copied. An error that may be the source's is looked into byte by byte.
    Status copy_from(const File& source, std::uint64_t source_offset, std::uint64_t offset, std::uint64_t length);
    // Has the disk begin to write what these bytes hold, and does not wait for it: the sync at the end has less to do.
    void begin_writeback(std::uint64_t offset, std::uint64_t length);
    Status truncate(std::uint64_t size);
    Status sync_data();
    Status close();

 private:
    File(int fd, std::filesystem::path path) : fd_(fd), path_(std::move(path)) {}
    friend class OutputFile;

    int fd_ = -1;
    std::filesystem::path path_;
};

// A file that will be `path` once `publish` succeeds; until then nothing of that name is there, or what was there stays. Where
// the file system allows it the file has no name at all meanwhile; else, and for a moment when it replaces another, a hidden one
// (hidden_name.h). What a killed process left of those is removed when the same output is next created.
class OutputFile {
 public:
    // Errors: kExists if `path` exists and `replace` is false (checked again, atomically, by `publish`).
    static Result<OutputFile> create(const std::filesystem::path& path, bool replace);
    OutputFile(OutputFile&&) noexcept = default;
    OutputFile& operator=(OutputFile&&) noexcept = delete;

    File& file() { return file_; }
    const std::filesystem::path& path() const { return path_; }
    // Syncs, closes and names the file.
    Status publish();

 private:
    OutputFile() = default;

    File file_;
    std::filesystem::path path_;
    TemporaryPath temporary_;  // empty: the file has no name yet
    bool replace_ = false;
};

// Gives the file `from` the name `to` unless that name is taken (kExists). Where the file system has no hard links, `from` is
// renamed instead of named twice. Atomic, except where rename_without_replacing is not.
Status name_without_replacing(const std::filesystem::path& from, const std::filesystem::path& to);

// Renames unless the name `to` is taken: returns 0, or errno (EEXIST). Atomic, except on file systems that cannot promise it (some
// mounts of servers and object stores): there, what takes the name in the same moment is replaced.
int rename_without_replacing(const std::filesystem::path& from, const std::filesystem::path& to);

// Makes names that were created, linked or removed in `folder` survive a power cut.
Status sync_folder(const std::filesystem::path& folder);

// The folder that holds `path`: "." for a bare name.
std::filesystem::path folder_of(const std::filesystem::path& path);

// Bytes that a file of this name may take, those of the file that it replaces included; none if the system does not say.
std::optional<std::uint64_t> free_space(const std::filesystem::path& path, bool replace);

// 16 hexadecimal digits that no other process or call will come up with.
std::string make_nonce();

}  // namespace latent
