// sampledb/read/recent_cache.h: a cache of the values used last, as many as fit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <utility>

namespace latent::sampledb {

// Values by key. Those that were used longest ago go first; whoever still holds one keeps it. Not thread-safe.
template <class Value>
class RecentCache {
 public:
    // `capacity`: the sum of costs that it holds; a single value may exceed it.
    explicit RecentCache(std::uint64_t capacity) : capacity_(capacity) {}

    std::shared_ptr<const Value> find(std::size_t key) {
        const auto it = entries_.find(key);
        if (it == entries_.end()) return nullptr;
        recent_.splice(recent_.begin(), recent_, it->second.place);
        return it->second.value;
    }
    void insert(std::size_t key, std::shared_ptr<const Value> value, std::uint64_t cost) {
        if (entries_.count(key) != 0) return;
        recent_.push_front(key);
        entries_[key] = {std::move(value), cost, recent_.begin()};
        held_ += cost;
        shrink(1);
    }
    // Drops what a value of that cost would push out, before it is made.
    void make_room(std::uint64_t cost) {
        held_ += cost;
        shrink(0);
        held_ -= cost;
    }

 private:
    void shrink(std::size_t least) {
        while (held_ > capacity_ && recent_.size() > least) {
            const auto oldest = entries_.find(recent_.back());
            held_ -= oldest->second.cost;
            entries_.erase(oldest);
            recent_.pop_back();
        }
    }

    struct Entry {
        std::shared_ptr<const Value> value;
        std::uint64_t cost;
        std::list<std::size_t>::iterator place;
    };
    std::uint64_t capacity_;
    std::uint64_t held_ = 0;
    std::map<std::size_t, Entry> entries_;
    std::list<std::size_t> recent_;
};

}  // namespace latent::sampledb
