#include "sampledb/http/http_source.h"

#include <algorithm>
#include <utility>

namespace latent::sampledb {

namespace {
// Reading in order reads ahead as much as was read so far, within these limits.
constexpr std::uint64_t kMinAhead = 256 << 10, kMaxAhead = 4 << 20;
}  // namespace

Result<std::shared_ptr<const HttpSource>> HttpSource::open(const std::string& url, std::shared_ptr<RangeCache> cache) {
    Result<RemoteFile> file = cache->open(url);
    if (!file) return file.error();
    return std::make_shared<const HttpSource>(std::move(*file), std::move(cache));
}

Status HttpSource::read(std::uint64_t offset, std::span<std::byte> into) const {
    if (!scattered_) read_ahead(offset, into.size());
    return cache_->read(file_, offset, into);
}

void HttpSource::read_ahead(std::uint64_t offset, std::uint64_t size) const {
    std::uint64_t begin = 0, end = 0;
    {
        const std::lock_guard lock(mutex_);
        auto stream = std::ranges::find(streams_, offset, &Stream::next);
        if (stream == streams_.end()) {
            stream = std::ranges::min_element(streams_, {}, &Stream::last_used);
            *stream = {};
        }
        stream->next = offset + size;
        stream->in_order += size;
        stream->last_used = ++reads_;
        const std::uint64_t ahead = std::min(stream->in_order, kMaxAhead);
        if (ahead < kMinAhead || stream->announced > stream->next + ahead / 2) return;
        begin = std::max(stream->announced, stream->next);
        end = stream->announced = stream->next + ahead;
    }
    cache_->announce(file_, begin, end - begin);
}

}  // namespace latent::sampledb
