// tools/darkroom/engine/picture_cache.h: developed pictures in memory, the least recently used of which make room for others.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "tools/darkroom/engine/kept_picture.h"

namespace latent::darkroom {

// For any number of threads.
class PictureCache {
 public:
    explicit PictureCache(std::uint64_t most_bytes) : most_(most_bytes) {}

    // Null if it is not there.
    std::shared_ptr<const KeptPicture> find(const std::string& key) {
        const std::scoped_lock lock(mutex_);
        for (auto it = entries_.begin(); it != entries_.end(); ++it) {
            if (it->key != key) continue;
            entries_.splice(entries_.begin(), entries_, it);
            return it->picture;
        }
        return nullptr;
    }
    // One that is larger than all that may be kept is not.
    void keep(const std::string& key, std::shared_ptr<const KeptPicture> picture) {
        const std::uint64_t bytes = picture->bytes();
        const std::scoped_lock lock(mutex_);
        while (!entries_.empty() && held_ + bytes > most_) {
            held_ -= entries_.back().bytes;
            entries_.pop_back();
        }
        if (bytes > most_) return;
        held_ += bytes;
        entries_.push_front({key, std::move(picture), bytes});
    }

 private:
    struct Entry {
        std::string key;
        std::shared_ptr<const KeptPicture> picture;
        std::uint64_t bytes;
    };
    std::mutex mutex_;
    std::uint64_t most_, held_ = 0;
    std::list<Entry> entries_;  // most recently used first
};

}  // namespace latent::darkroom
