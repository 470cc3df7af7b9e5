// sampledb/http/http_connection.h: ranges of bytes from web servers, by libcurl; what goes wrong on the way is tried again.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "base/bytes.h"
#include "base/result.h"
#include "sampledb/http/range_answer.h"

namespace latent::sampledb {

struct Patience {
    int tries = 5;             // that bring no byte
    double first_wait = 0.25;  // seconds before the second try; twice as long before each that follows, or what the server asks for
    int connect_seconds = 15;
    int stalled_seconds = 30;  // without a byte, until the try ends
    double lag_seconds = 50;   // how far a connection, with all its tries, may fall behind 1 KiB/s
};

struct Fetched {
    Bytes bytes;
    RemoteVersion version;
};

// One transfer at a time; the connection stays open for the next.
class HttpConnection {
 public:
    explicit HttpConnection(const Patience& patience);
    ~HttpConnection();

    // Bytes offset .. offset+size-1 of a file, or up to its end if `known` is null: then this opens the file. Otherwise it must
    // still be of that version, or have grown. Redirections are followed, from https to https only; certificates are verified;
    // proxies and .netrc count as with curl. `stop`: give up soon. Errors, with the URL: kNotFound, kIo, kStopped.
    Result<Fetched> get(const std::string& url, std::uint64_t offset, std::uint64_t size, const RemoteVersion* known,
                        const std::atomic<bool>& stop);

 private:
    struct Handle;
    std::unique_ptr<Handle> handle_;
    const Patience patience_;
    double lag_ = 0;  // seconds that it is behind
};

}  // namespace latent::sampledb
