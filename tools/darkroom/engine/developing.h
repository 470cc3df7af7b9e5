// tools/darkroom/engine/developing.h: pictures that are being developed, one after the other. What nobody waits for any more is
// given up.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "base/progress.h"
#include "base/result.h"
#include "tools/darkroom/engine/kept_picture.h"

namespace latent::darkroom {

class Developing {
 public:
    using Made = Result<std::shared_ptr<const KeptPicture>>;
    using Work = std::function<Made(const Stopped&)>;

    Developing() : worker_([this] { run(); }) {}
    ~Developing();  // gives up
    Developing(const Developing&) = delete;
    Developing& operator=(const Developing&) = delete;

    // What `work` makes, on the thread of this object. Those who ask for the same `key` meanwhile wait for the same piece of work.
    // Errors: of `work`; kStopped, soon after `stopped` is true.
    Made wait_for(const std::string& key, Work work, const Stopped& stopped);

 private:
    using Clock = std::chrono::steady_clock;
    struct Job {
        std::string key;
        Work work;
        std::atomic<int> waiting = 0;  // who wants it
        std::atomic<bool> given_up = false;
        Clock::time_point left;  // by the last of them
        std::optional<Made> made;
    };
    void run();
    bool is_unwanted(Job& job);

    std::mutex mutex_;
    std::condition_variable changed_;
    std::shared_ptr<Job> running_;
    std::list<std::shared_ptr<Job>> queue_;  // that are wanted, after that one
    bool ends_ = false;
    std::thread worker_;
};

}  // namespace latent::darkroom
