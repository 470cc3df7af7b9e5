// base/parallel.h: --threads. Everything parallel runs inside one `Threads`, on oneTBB.
#pragma once

#include <functional>
#include <memory>

namespace latent {

// Bounds the worker threads of this process to `count` (0: as many as the machine has) while it lives.
class Threads {
 public:
    explicit Threads(int count);
    ~Threads();
    int count() const { return count_; }
    // Runs `work` inside the bounded arena: tbb::parallel_for and the like in it use at most `count` threads.
    void run(const std::function<void()>& work) const;

 private:
    struct Arena;
    std::unique_ptr<Arena> arena_;
    int count_;
};

}  // namespace latent
