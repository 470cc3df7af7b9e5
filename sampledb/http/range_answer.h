// sampledb/http/range_answer.h: what a web server answers when it is asked for a range of a file [RFC9110 14]. Takes nothing on
// trust: the answer may come from anybody.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/bytes.h"
#include "base/result.h"

namespace latent::sampledb {

// Tells whether a file on a server is still the one that was opened.
struct RemoteVersion {
    std::uint64_t size = 0;  // bytes, at most 2^63-1
    std::string modified;    // Last-Modified as the server writes it; empty: it does not say
};

// One answer, as it arrives: the lines of its header, then its bytes.
class RangeAnswer {
 public:
    // Asked for: bytes offset .. offset+size-1. `known`: the version of the file when it was opened; null: this opens it.
    // Bytes are added to the end of `into`.
    RangeAnswer(std::uint64_t offset, std::uint64_t size, const RemoteVersion* known, Bytes& into)
        : offset_(offset), size_(size), known_(known), into_(into) {}

    // Both return false if the transfer is to be cut off: what comes would not be used, or everything is there and the server has
    // not said that the answer ends here.
    bool take_header(std::string_view line);  // a status line begins another answer, after a redirection
    bool take_bytes(ByteSpan bytes);

    int status() const { return status_; }  // HTTP's; 0: no answer
    std::uint64_t received() const { return received_; }
    // The version of the file, if the answer tells.
    const std::optional<RemoteVersion>& version() const { return version_; }

    // Why asking again would not help. Errors: kNotFound; kIo. `whole`: the transfer ended as the server meant it to.
    Status verdict(bool whole) const;

 private:
    Status verdict_on_range(bool whole) const;
    Status verdict_on_version() const;

    std::uint64_t offset_, size_;
    const RemoteVersion* known_;
    Bytes& into_;

    std::uint64_t header_bytes_ = 0;  // counted over all answers
    std::uint64_t received_ = 0;      // bytes, of an error's page too
    int status_ = 0;
    std::uint64_t first_ = 0, announced_ = 0;  // Content-Range: first byte, number of bytes
    std::uint64_t length_ = 0;                 // Content-Length; 0: none
    std::optional<RemoteVersion> version_;     // from Content-Range
    std::string modified_;
    bool encoded_ = false;
    bool took_bytes_ = false;  // whether bytes of the file have come
};

}  // namespace latent::sampledb
