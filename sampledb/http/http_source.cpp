#include "sampledb/http/http_source.h"

#include <algorithm>
#include <utility>

namespace latent::sampledb {

namespace {
// Of what is read in order: as much is read ahead as was read, within these.
constexpr std::uint64_t kLeastAhead = 256 << 10, kMostAhead = 4 << 20;
}  // namespace

Result<std::shared_ptr<const HttpSource>> HttpSource::open(const std::string& url, std::shared_ptr<BlockCache> cache) {
    Result<RemoteFile> file = cache->open(url);
    if (!file) return file.error();
    return std::make_shared<const HttpSource>(std::move(*file), std::move(cache));
}

Status HttpSource::read(std::uint64_t offset, std::span<std::byte> into) const {
    const std::uint64_t end = offset + into.size();
    in_order_ = next_.exchange(end) == offset ? in_order_ + into.size() : into.size();
    if (!scattered_ && in_order_ >= kLeastAhead) cache_->announce(file_, end, std::min<std::uint64_t>(in_order_, kMostAhead));
    return cache_->read(file_, offset, into);
}

}  // namespace latent::sampledb
