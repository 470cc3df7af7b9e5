// sampledb/http/http_source.h: the bytes of a file on a web server that answers range requests.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <string>

#include "base/url.h"
#include "sampledb/http/range_cache.h"
#include "sampledb/read/byte_source.h"

namespace latent::sampledb {

class HttpSource final : public ByteSource {
 public:
    // Sources may share a cache. Errors: those of HttpConnection.
    static Result<std::shared_ptr<const HttpSource>> open(const std::string& url, std::shared_ptr<RangeCache> cache);

    std::uint64_t size() const override { return file_.version.size; }
    Status read(std::uint64_t offset, std::span<std::byte> into) const override;
    std::string name() const override { return shown_name(file_.url); }
    void expect_scattered_reads() const override { scattered_ = true; }
    void will_read(std::uint64_t offset, std::uint64_t length) const override { cache_->announce(file_, offset, length); }

    HttpSource(RemoteFile file, std::shared_ptr<RangeCache> cache) : file_(std::move(file)), cache_(std::move(cache)) {}

 private:
    // Reads that follow each other, such as those of an index and of its pages in turn.
    struct Stream {
        std::uint64_t next = 0, in_order = 0,
                      announced = 0;  // bytes: where it goes on, how many it has read, up to where it read ahead
        std::uint64_t last_used = 0;
    };
    void read_ahead(std::uint64_t offset, std::uint64_t size) const;

    RemoteFile file_;
    std::shared_ptr<RangeCache> cache_;
    mutable std::atomic<bool> scattered_ = false;
    mutable std::mutex mutex_;
    mutable std::array<Stream, 4> streams_;
    mutable std::uint64_t reads_ = 0;
};

}  // namespace latent::sampledb
