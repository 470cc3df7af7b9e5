// sampledb/http/block_cache.h: pieces of remote files, those that were used last and those on their way, in bounded memory.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sampledb/http/transfers.h"

namespace latent::sampledb {

struct RemoteFile {
    std::uint64_t number = 0;  // another for each file that is open
    std::string url;
    std::uint64_t size = 0;
};

// Thread-safe.
class BlockCache {
 public:
    static constexpr std::uint64_t kBlock = 1 << 10;       // bytes at most; no block crosses a multiple of it
    static constexpr std::uint64_t kOpening = 16 << 10;    // bytes that a file is opened with: the header, most often
    static constexpr std::uint64_t kTransfer = 128 << 10;  // bytes of neighbours that are asked for at once
    static constexpr std::uint64_t kCapacity = 32 << 20;   // bytes, with what it takes to keep them
    static constexpr std::uint64_t kMostAhead = 16 << 20;  // bytes on their way, beyond which nothing is announced
    static constexpr std::size_t kConnections = 32;

    explicit BlockCache(const Patience& patience) : transfers_(kConnections, patience) {}

    // Opens a file with its first bytes: they tell its size.
    Result<RemoteFile> open(const std::string& url);
    // Errors: kTruncated (the file ends before), those of HttpConnection.
    Status read(const RemoteFile& file, std::uint64_t offset, std::span<std::byte> into);
    // These bytes, and no others, are asked for now, unless much is on its way already.
    void announce(const RemoteFile& file, std::uint64_t offset, std::uint64_t length);

 private:
    using Key = std::pair<std::uint64_t, std::uint64_t>;  // file, first byte
    struct Block {
        std::uint64_t begin = 0;
        bool done = false;
        Status status;
        Bytes bytes;
        std::list<Key>::iterator place;  // in recent_, or in waiting_ until it is done
        std::uint64_t end() const { return begin + bytes.size(); }
    };
    using Blocks = std::vector<std::shared_ptr<Block>>;

    Blocks blocks_of(const RemoteFile& file, std::uint64_t begin, std::uint64_t end, bool urgent);
    std::shared_ptr<Block> block_at(const RemoteFile& file, std::uint64_t at, std::uint64_t end, bool urgent, bool& is_new);
    std::shared_ptr<Block> make_block(const RemoteFile& file, std::uint64_t begin, std::uint64_t end);
    void request(const RemoteFile& file, const Blocks& blocks, bool urgent);
    void finish(const Blocks& blocks, const Result<Fetched>& fetched);
    Status wait_and_copy(const Blocks& blocks, std::uint64_t offset, std::span<std::byte> into);

    std::mutex mutex_;
    std::condition_variable arrived_;
    std::map<Key, std::shared_ptr<Block>> blocks_;
    std::list<Key> recent_, waiting_;  // those that are there, used last comes first; those on their way
    std::uint64_t on_their_way_ = 0;   // bytes
    std::uint64_t files_ = 0;          // opened so far
    Transfers transfers_;              // the first to go: its threads use all that is above
};

}  // namespace latent::sampledb
