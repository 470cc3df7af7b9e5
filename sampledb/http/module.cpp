#include "sampledb/http/module.h"

#include <mutex>

#include "sampledb/http/http_source.h"

const char* latent_http_version() { return LATENT_VERSION; }

void latent_open_http(const std::string& url, std::shared_ptr<const latent::sampledb::ByteSource>& source, latent::Status& status) {
    using namespace latent::sampledb;
    static std::mutex mutex;
    static std::weak_ptr<RangeCache> shared;
    std::shared_ptr<RangeCache> cache;
    {
        const std::lock_guard lock(mutex);
        cache = shared.lock();
        if (!cache) shared = cache = std::make_shared<RangeCache>(Patience{});
    }
    latent::Result<std::shared_ptr<const HttpSource>> opened = HttpSource::open(url, std::move(cache));
    if (!opened) {
        status = opened.error();
        return;
    }
    source = std::move(*opened);
}
