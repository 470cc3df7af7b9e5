// base/parallel.h: --threads. `Threads`, on oneTBB, for pure computation; `Workers` for work that also waits, such as for a disk.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "base/first_error.h"
#include "base/result.h"

namespace latent {

// Errors: kIo, the system refuses more threads.
Result<std::thread> start_thread(std::function<void()> work);

// Threads of their own that run work(0) ... work(count - 1).
class Workers {
 public:
    // What one of them throws, or that one cannot be started, is kept in `error`: the others should look there, and stop.
    Workers(int count, FirstError& error, std::function<void(int)> work);
    ~Workers();  // waits for all
    // Waits for all, but no longer than `seconds`; returns whether they have ended.
    bool wait(std::chrono::duration<double> seconds);

 private:
    std::function<void(int)> work_;
    std::mutex mutex_;
    std::condition_variable ended_;
    int running_ = 0;
    std::vector<std::thread> threads_;
};

// Bounds the worker threads of this process to `count` (0: as many as the machine has) while it lives.
class Threads {
 public:
    // Throws std::runtime_error if the system refuses so many threads: oneTBB may not survive to find out itself.
    explicit Threads(int count);
    ~Threads();
    int count() const { return count_; }
    static int count_of(int asked);  // what `count` would be
    // Runs `work` inside the bounded arena: tbb::parallel_for and the like in it use at most `count` threads.
    void run(const std::function<void()>& work) const;

 private:
    struct Arena;
    std::unique_ptr<Arena> arena_;
    int count_;
};

}  // namespace latent
