#include "sampledb/http/block_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <future>

#include "base/url.h"

namespace latent::sampledb {

namespace {
constexpr std::uint64_t kStretch = 4 << 20;  // bytes that a long read asks for at once
constexpr std::uint64_t kKeeping = 256;      // bytes of memory beside those of a block
}  // namespace

Result<RemoteFile> BlockCache::open(const std::string& url) {
    std::promise<Result<Fetched>> promise;
    transfers_.add({url, 0, kOpening, [&](Result<Fetched> fetched) { promise.set_value(std::move(fetched)); }}, true);
    const Result<Fetched> fetched = promise.get_future().get();
    if (!fetched) return fetched.error();
    const std::lock_guard lock(mutex_);
    RemoteFile file{++files_, url, fetched->file_size};
    Blocks blocks;
    const std::uint64_t end = fetched->bytes.size();
    for (std::uint64_t at = 0; at < end; at += kBlock) blocks.push_back(make_block(file, at, std::min(at + kBlock, end)));
    finish(blocks, fetched);
    return file;
}

Status BlockCache::read(const RemoteFile& file, std::uint64_t offset, std::span<std::byte> into) {
    if (offset > file.size || into.size() > file.size - offset)
        return Error{ErrorCode::kTruncated, fmt::format("{}: ends at byte {}", shown_name(file.url), file.size)};
    while (!into.empty()) {
        const std::span<std::byte> stretch = into.first(std::min<std::size_t>(into.size(), kStretch));
        const Blocks blocks = blocks_of(file, offset, offset + stretch.size(), true);
        if (Status s = wait_and_copy(blocks, offset, stretch); !s) return s;
        offset += stretch.size();
        into = into.subspan(stretch.size());
    }
    return {};
}

void BlockCache::announce(const RemoteFile& file, std::uint64_t offset, std::uint64_t length) {
    const std::uint64_t end = offset < file.size ? offset + std::min(length, file.size - offset) : 0;
    if (offset < end) blocks_of(file, offset, end, false);
}

// The blocks of bytes begin .. end-1, which are asked for if they are not there; of what is only announced, as many as there is
// room for.
BlockCache::Blocks BlockCache::blocks_of(const RemoteFile& file, std::uint64_t begin, std::uint64_t end, bool urgent) {
    const std::lock_guard lock(mutex_);
    Blocks found, asked;
    const auto request_asked = [&] {
        if (!asked.empty()) request(file, asked, urgent);
        asked.clear();
    };
    for (std::uint64_t at = begin; at < end && (urgent || on_their_way_ < kMostAhead); at = found.back()->end()) {
        bool is_new = false;
        found.push_back(block_at(file, at, end, urgent, is_new));
        if (is_new) asked.push_back(found.back());
        if (!is_new || asked.size() == kTransfer / kBlock) request_asked();
    }
    request_asked();
    return found;
}

// The block that holds byte `at`. One that is new ends at `end` if it is only announced: the server is asked for no byte that
// nobody may want. But who reads without having announced it may well go on nearby, and gets all that is missing around.
std::shared_ptr<BlockCache::Block> BlockCache::block_at(const RemoteFile& file, std::uint64_t at, std::uint64_t end, bool urgent,
                                                        bool& is_new) {
    const std::uint64_t first = at / kBlock * kBlock;
    std::uint64_t from = urgent ? first : at, to = std::min(file.size, first + kBlock);
    if (!urgent) to = std::min(to, end);
    const auto next = blocks_.upper_bound({file.number, at});
    if (next != blocks_.end() && next->first.first == file.number) to = std::min(to, next->second->begin);
    if (next != blocks_.begin() && std::prev(next)->first.first == file.number) {
        const std::shared_ptr<Block>& before = std::prev(next)->second;
        if (before->end() > at) {
            if (before->done) recent_.splice(recent_.begin(), recent_, before->place);
            return before;
        }
        from = std::max(from, before->end());
    }
    is_new = true;
    return make_block(file, from, to);
}

// One that is on its way, with all the memory that its arrival will take.
std::shared_ptr<BlockCache::Block> BlockCache::make_block(const RemoteFile& file, std::uint64_t begin, std::uint64_t end) {
    const Key key{file.number, begin};
    auto block = std::make_shared<Block>();
    block->begin = begin;
    block->bytes.resize(end - begin);
    block->place = waiting_.insert(waiting_.end(), key);
    blocks_[key] = block;
    on_their_way_ += kBlock;
    return block;
}

// `blocks`: neighbours.
void BlockCache::request(const RemoteFile& file, const Blocks& blocks, bool urgent) {
    const std::uint64_t offset = blocks.front()->begin, size = blocks.back()->end() - offset;
    const Status added = caught([&]() -> Status {
        const auto done = [this, blocks](const Result<Fetched>& fetched) {
            const std::lock_guard lock(mutex_);
            finish(blocks, fetched);
        };
        transfers_.add({file.url, offset, size, done}, urgent);
        return {};
    });
    if (!added) finish(blocks, added.error());
}

// Neighbours have arrived, or will not.
void BlockCache::finish(const Blocks& blocks, const Result<Fetched>& fetched) {
    std::size_t at = 0;
    for (const std::shared_ptr<Block>& block : blocks) {
        block->done = true;
        on_their_way_ -= kBlock;
        recent_.splice(recent_.begin(), waiting_, block->place);
        if (fetched && fetched->bytes.size() - at >= block->bytes.size()) {
            std::copy_n(fetched->bytes.begin() + static_cast<std::ptrdiff_t>(at), block->bytes.size(), block->bytes.begin());
            at += block->bytes.size();
            continue;
        }
        block->status = fetched ? Error{ErrorCode::kTruncated, "the file on the server has become shorter"} : fetched.error();
        blocks_.erase(recent_.front());  // a later read may fare better
        recent_.pop_front();
    }
    while (recent_.size() * (kBlock + kKeeping) > kCapacity) {
        blocks_.erase(recent_.back());
        recent_.pop_back();
    }
    arrived_.notify_all();
}

Status BlockCache::wait_and_copy(const Blocks& blocks, std::uint64_t offset, std::span<std::byte> into) {
    for (const std::shared_ptr<Block>& block : blocks) {
        {
            std::unique_lock lock(mutex_);
            arrived_.wait(lock, [&] { return block->done; });
        }
        if (!block->status) return block->status;
        const std::size_t skip = offset - block->begin, count = std::min(block->bytes.size() - skip, into.size());
        std::copy_n(block->bytes.begin() + static_cast<std::ptrdiff_t>(skip), count, into.begin());
        into = into.subspan(count);
        offset += count;
    }
    return {};
}

}  // namespace latent::sampledb
