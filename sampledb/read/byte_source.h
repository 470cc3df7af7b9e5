// sampledb/read/byte_source.h: where the bytes of a Latent file come from: a file on disk or on a web server, or memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "base/bytes.h"
#include "base/file.h"
#include "base/result.h"

namespace latent::sampledb {

// Thread-safe: reads at any offset, no position of its own.
class ByteSource {
 public:
    virtual ~ByteSource() = default;
    // The length when it was opened; a file that grows meanwhile is read up to here.
    virtual std::uint64_t size() const = 0;
    // Exactly `into.size()` bytes. Errors: kTruncated past the end, kIo.
    virtual Status read(std::uint64_t offset, std::span<std::byte> into) const = 0;
    virtual std::string name() const = 0;  // for messages
    // All bytes from `offset` up to here are zero, without being stored: a hole of a file.
    virtual std::uint64_t end_of_hole(std::uint64_t offset) const { return offset; }
    // Hints, which may come to nothing: reads come here and there; these bytes are read soon, and may be on their way.
    virtual void expect_scattered_reads() const {}
    virtual void will_read(std::uint64_t, std::uint64_t) const {}
    virtual const File* file() const { return nullptr; }  // that it is, if it is one on disk
};

// Opens a path or a URL (remote_source.h). Errors: those of FileSource::open and open_remote.
Result<std::shared_ptr<const ByteSource>> open_source(const std::filesystem::path& path);

// Copies `length` bytes into a file, inside the kernel where it can. Errors: those of `source`, and of writing.
Status copy_bytes(const ByteSource& source, std::uint64_t source_offset, File& file, std::uint64_t offset, std::uint64_t length);

class FileSource final : public ByteSource {
 public:
    // Errors: kNotFound, kForeign (a folder), kIo.
    static Result<FileSource> open(const std::filesystem::path& path);
    std::uint64_t size() const override { return size_; }
    Status read(std::uint64_t offset, std::span<std::byte> into) const override;
    std::string name() const override { return file_.path().string(); }
    std::uint64_t end_of_hole(std::uint64_t offset) const override;
    void expect_scattered_reads() const override { file_.expect_scattered_reads(); }
    void will_read(std::uint64_t offset, std::uint64_t length) const override { file_.will_read(offset, length); }
    const File* file() const override { return &file_; }

 private:
    FileSource(File file, std::uint64_t size) : file_(std::move(file)), size_(size) {}

    File file_;
    std::uint64_t size_;
};

// Looks at a file that the caller keeps open: one that has no name yet, say.
class FileView final : public ByteSource {
 public:
    FileView(const File& file, std::string name, std::uint64_t size) : file_(file), name_(std::move(name)), size_(size) {}
    std::uint64_t size() const override { return size_; }
    Status read(std::uint64_t offset, std::span<std::byte> into) const override { return file_.read_exact(offset, into); }
    std::string name() const override { return name_; }

 private:
    const File& file_;
    std::string name_;
    std::uint64_t size_;
};

// Looks at bytes that the caller keeps.
class MemorySource final : public ByteSource {
 public:
    explicit MemorySource(ByteSpan bytes, std::string name = "memory") : bytes_(bytes), name_(std::move(name)) {}
    std::uint64_t size() const override { return bytes_.size(); }
    Status read(std::uint64_t offset, std::span<std::byte> into) const override;
    std::string name() const override { return name_; }

 private:
    ByteSpan bytes_;
    std::string name_;
};

}  // namespace latent::sampledb
