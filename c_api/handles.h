// c_api/handles.h: what latent_writer*, latent_reader* and latent_cursor* are: numbers, none of them given twice. So a handle that
// was closed, or that no function gave, is known as such, and an object lives until the last call on it returns.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <utility>

#include "base/result.h"

namespace latent::c {

template <class T>
class Handles {
 public:
    // Those of a process. They are never destroyed: programs may close handles as late as they like.
    static Handles& open() {
        static Handles& handles = *new Handles;
        return handles;
    }

    T* add(std::shared_ptr<T> object) {
        const std::lock_guard lock(mutex_);
        // NOLINTNEXTLINE(performance-no-int-to-ptr): nothing is at that address
        T* const handle = reinterpret_cast<T*>(last_ += 16);
        objects_.emplace(handle, std::move(object));
        return handle;
    }
    // Errors: kUsage: not open. `name`: of the parameter.
    Result<std::shared_ptr<T>> find(const T* handle, const char* name) const {
        if (std::shared_ptr<T> object = look_up(handle)) return object;
        return usage_error(std::string(name) + (handle == nullptr ? " is null" : " is closed"));
    }
    // Null if there is none.
    std::shared_ptr<T> look_up(const T* handle) const {
        const std::lock_guard lock(mutex_);
        const auto at = objects_.find(handle);
        return at == objects_.end() ? nullptr : at->second;
    }
    // The same, closed.
    std::shared_ptr<T> take(const T* handle) {
        const std::lock_guard lock(mutex_);
        auto node = objects_.extract(handle);
        return node.empty() ? nullptr : std::move(node.mapped());
    }

 private:
    mutable std::mutex mutex_;
    std::uintptr_t last_ = 0;
    std::unordered_map<const T*, std::shared_ptr<T>> objects_;
};

}  // namespace latent::c
