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
    for (std::uint64_t at = 0; at < fetched->bytes.size(); at += kBlock) blocks.push_back(make_block(file, at / kBlock));
    finish(blocks, fetched);
    return file;
}

Status BlockCache::read(const RemoteFile& file, std::uint64_t offset, std::span<std::byte> into) {
    if (offset > file.size || into.size() > file.size - offset)
        return Error{ErrorCode::kTruncated, fmt::format("{}: ends at byte {}", shown_name(file.url), file.size)};
    while (!into.empty()) {
        const std::span<std::byte> stretch = into.first(std::min<std::size_t>(into.size(), kStretch));
        const Blocks blocks = blocks_of(file, offset / kBlock, (offset + stretch.size() - 1) / kBlock, true);
        if (Status s = wait_and_copy(blocks, offset % kBlock, stretch); !s) return s;
        offset += stretch.size();
        into = into.subspan(stretch.size());
    }
    return {};
}

void BlockCache::announce(const RemoteFile& file, std::uint64_t offset, std::uint64_t length) {
    const std::uint64_t end = offset < file.size ? offset + std::min(length, file.size - offset) : 0;
    if (offset < end) blocks_of(file, offset / kBlock, (end - 1) / kBlock, false);
}

// Blocks first .. last, which are asked for if they are not there; of what is only announced, as many as there is room for.
BlockCache::Blocks BlockCache::blocks_of(const RemoteFile& file, std::uint64_t first, std::uint64_t last, bool urgent) {
    const std::lock_guard lock(mutex_);
    Blocks found, asked;
    std::uint64_t asked_first = first;
    const auto request_asked = [&] {
        if (!asked.empty()) request(file, asked_first, asked, urgent);
        asked.clear();
    };
    for (std::uint64_t number = first; number <= last && (urgent || on_their_way_ < kMostAhead); ++number) {
        const auto known = blocks_.find({file.number, number});
        if (known != blocks_.end()) {
            found.push_back(known->second);
            if (found.back()->done) recent_.splice(recent_.begin(), recent_, found.back()->place);
            request_asked();
            continue;
        }
        if (asked.empty()) asked_first = number;
        asked.push_back(make_block(file, number));
        found.push_back(asked.back());
        if (asked.size() * kBlock == kTransfer) request_asked();
    }
    request_asked();
    return found;
}

// One that is on its way, with all the memory that its arrival will take.
std::shared_ptr<BlockCache::Block> BlockCache::make_block(const RemoteFile& file, std::uint64_t number) {
    const Key key{file.number, number};
    auto block = std::make_shared<Block>();
    block->bytes.resize(std::min(kBlock, file.size - number * kBlock));
    block->place = waiting_.insert(waiting_.end(), key);
    blocks_[key] = block;
    on_their_way_ += kBlock;
    return block;
}

void BlockCache::request(const RemoteFile& file, std::uint64_t first, const Blocks& blocks, bool urgent) {
    const std::uint64_t offset = first * kBlock, size = std::min(blocks.size() * kBlock, file.size - offset);
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

// `at`: in the first of the blocks.
Status BlockCache::wait_and_copy(const Blocks& blocks, std::uint64_t at, std::span<std::byte> into) {
    for (const std::shared_ptr<Block>& block : blocks) {
        {
            std::unique_lock lock(mutex_);
            arrived_.wait(lock, [&] { return block->done; });
        }
        if (!block->status) return block->status;
        const std::size_t count = std::min<std::size_t>(block->bytes.size() - at, into.size());
        std::copy_n(block->bytes.begin() + static_cast<std::ptrdiff_t>(at), count, into.begin());
        into = into.subspan(count);
        at = 0;
    }
    return {};
}

}  // namespace latent::sampledb
