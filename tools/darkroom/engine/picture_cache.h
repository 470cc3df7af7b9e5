// tools/darkroom/engine/picture_cache.h: developed pictures in memory, the least recently used of which make room for others.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <string>
#include <utility>

#include "base/file.h"

namespace latent::darkroom {

class PictureCache {
 public:
    explicit PictureCache(std::uint64_t most_bytes) : most_(most_bytes) {}

    // Null if it is not there.
    std::shared_ptr<const File> find(const std::string& key) {
        for (auto it = entries_.begin(); it != entries_.end(); ++it) {
            if (it->key != key) continue;
            entries_.splice(entries_.begin(), entries_, it);
            return it->file;
        }
        return nullptr;
    }
    // One that is larger than all that may be kept is not.
    void keep(const std::string& key, std::shared_ptr<const File> file) {
        const std::uint64_t bytes = file->size().value_or(0);
        while (!entries_.empty() && held_ + bytes > most_) {
            held_ -= entries_.back().bytes;
            entries_.pop_back();
        }
        if (bytes > most_) return;
        held_ += bytes;
        entries_.push_front({key, std::move(file), bytes});
    }
    std::uint64_t bytes() const { return held_; }

 private:
    struct Entry {
        std::string key;
        std::shared_ptr<const File> file;
        std::uint64_t bytes;
    };
    std::uint64_t most_, held_ = 0;
    std::list<Entry> entries_;  // most recently used first
};

}  // namespace latent::darkroom
