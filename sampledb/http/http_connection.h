// sampledb/http/http_connection.h: ranges of bytes from web servers, by libcurl; what goes wrong on the way is tried again.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "base/bytes.h"
#include "base/result.h"

namespace latent::sampledb {

struct Patience {
    int tries = 5;             // without a byte, until the transfer is given up
    double first_wait = 0.25;  // seconds before the second; twice as long before each that follows, or what the server asks for
    int connect_seconds = 15;
    int stalled_seconds = 30;  // without a byte
};

struct Fetched {
    Bytes bytes;
    std::uint64_t file_size = 0;
};

// One transfer at a time; the connection stays open for the next.
class HttpConnection {
 public:
    explicit HttpConnection(const Patience& patience);
    ~HttpConnection();

    // Bytes offset .. offset+size-1 of a file, or up to its end. Redirections are followed; https is verified; proxies and .netrc
    // count as with curl. `stop`: give up soon. Errors, with the URL: kNotFound, kTruncated (the file ends before `offset`), kIo.
    Result<Fetched> get(const std::string& url, std::uint64_t offset, std::uint64_t size, const std::atomic<bool>& stop);

 private:
    struct Answer;
    Answer ask(const std::string& url, std::uint64_t offset, std::uint64_t size, Bytes& into, const std::atomic<bool>& stop);

    struct Handle;
    std::unique_ptr<Handle> handle_;
    const Patience patience_;
};

}  // namespace latent::sampledb
