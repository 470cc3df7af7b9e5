// sampledb/http/range_cache.h: ranges of remote files, those used last and those on their way, in bounded memory.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sampledb/http/transfers.h"

namespace latent::sampledb {

struct RemoteFile {
    std::uint64_t number = 0;  // another for each file that is open
    std::string url;
    RemoteVersion version;  // when it was opened
};

// Thread-safe.
class RangeCache {
 public:
    static constexpr std::uint64_t kOpening = 16 << 10;    // bytes that a file is opened with: the header, most often
    static constexpr std::uint64_t kTransfer = 128 << 10;  // bytes of one request at most
    // Bytes between announced ranges that one request gets along with them: less than a server and a line do in the time of a
    // request.
    static constexpr std::uint64_t kGap = 16 << 10;
    // A read that was not announced gets the bytes around it too, between multiples of this: the next read may want them.
    static constexpr std::uint64_t kUnit = 1 << 10;
    static constexpr std::uint64_t kCapacity = 32 << 20;  // bytes, with what it takes to keep them
    static constexpr std::uint64_t kMaxAhead = 16 << 20;  // bytes on their way, beyond which nothing is announced
    static constexpr std::size_t kConnections = 32;

    explicit RangeCache(const Patience& patience) : transfers_(kConnections, patience) {}

    // Opens a file with its first bytes: they tell its size. Errors: those of HttpConnection.
    Result<RemoteFile> open(const std::string& url);
    // Errors: kTruncated (the file ended before, when it was opened), those of HttpConnection.
    Status read(const RemoteFile& file, std::uint64_t offset, std::span<std::byte> into);
    // These bytes are read soon. They are asked for, unless much is on its way already; the last ones wait for neighbours that may
    // be announced next, until a caller waits for anything.
    void announce(const RemoteFile& file, std::uint64_t offset, std::uint64_t length);

 private:
    using Key = std::pair<std::uint64_t, std::uint64_t>;  // file, first byte
    struct Range {
        RemoteFile file;
        std::uint64_t begin = 0, end = 0;
        bool is_here = false;
        Status status;  // valid for a block that is here
        Bytes bytes;
        std::list<Key>::iterator place;  // in recent_, of one that is here
    };
    using RangePointer = std::shared_ptr<Range>;
    struct Hole {
        std::uint64_t begin = 0, end = 0;
    };

    // These need the lock.
    RangePointer find(const RemoteFile& file, std::uint64_t at);
    Hole hole_at(const RemoteFile& file, std::uint64_t at) const;
    RangePointer add(const RemoteFile& file, std::uint64_t begin, std::uint64_t end);
    void plan(const RemoteFile& file, std::uint64_t begin, std::uint64_t end);
    void ask_for_planned(bool urgent);
    void ask(const RangePointer& range, bool urgent);
    void finish(const RangePointer& range, Result<Fetched> fetched);

    std::vector<RangePointer> cover(const RemoteFile& file, std::uint64_t begin, std::uint64_t end);
    Status wait_and_copy(const std::vector<RangePointer>& ranges, std::uint64_t offset, std::span<std::byte> into);

    std::mutex mutex_;
    std::condition_variable arrived_;
    std::map<Key, RangePointer> ranges_;  // those of a file do not overlap
    std::list<Key> recent_;               // those that are here, used last comes first
    RangePointer planned_;                // announced, may still grow, not yet asked for
    std::uint64_t held_ = 0;              // bytes of recent_
    std::uint64_t on_their_way_ = 0;      // bytes of the others
    std::uint64_t files_ = 0;             // opened so far
    Transfers transfers_;                 // the first to go: its threads use all that is above
};

}  // namespace latent::sampledb
