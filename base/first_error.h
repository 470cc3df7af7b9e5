// base/first_error.h: the first of the errors in many threads.
#pragma once

#include <atomic>
#include <mutex>

#include "base/result.h"

namespace latent {

class FirstError {
 public:
    void set(const Error& error) {
        const std::lock_guard lock(mutex_);
        if (!failed_) status_ = error;
        failed_ = true;
    }
    void keep(const Status& status) {
        if (!status) set(status.error());
    }
    explicit operator bool() const { return failed_; }  // there is one: other threads may stop
    const Status& status() const { return status_; }    // once all threads are done

 private:
    std::mutex mutex_;
    std::atomic<bool> failed_ = false;
    Status status_;
};

}  // namespace latent
