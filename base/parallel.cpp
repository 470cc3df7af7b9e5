#include "base/parallel.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <stdexcept>
#include <system_error>

namespace latent {

Result<std::thread> start_thread(std::function<void()> work) {
    try {
        return std::thread(std::move(work));
    } catch (const std::bad_alloc&) {
        return current_error();
    } catch (const std::system_error& refusal) {
        return Error{ErrorCode::kIo, fmt::format("cannot start a thread: {} (try fewer --threads, or a higher ulimit -u or -v)",
                                                 refusal.code().message())};
    }
}

Workers::Workers(int count, FirstError& error, std::function<void(int)> work) : work_(std::move(work)) {
    threads_.reserve(static_cast<std::size_t>(count));
    const auto run = [this, &error](int i) {
        try {
            work_(i);
        } catch (...) {
            error.set(current_error());
        }
        const std::lock_guard lock(mutex_);
        --running_;
        ended_.notify_all();
    };
    for (int i = 0; i < count && !error; ++i) {
        const std::lock_guard lock(mutex_);
        Result<std::thread> thread = start_thread([run, i] { run(i); });
        if (!thread) {
            error.set(thread.error());
            return;
        }
        threads_.push_back(std::move(*thread));
        ++running_;
    }
}

Workers::~Workers() {
    for (std::thread& thread : threads_) thread.join();
}

bool Workers::wait(std::chrono::duration<double> seconds) {
    std::unique_lock lock(mutex_);
    return ended_.wait_for(lock, seconds, [&] { return running_ == 0; });
}

namespace {
// Starts so many threads that live at the same time, and lets them end.
Status try_threads(int count) {
    FirstError error;
    std::mutex all_started;
    std::unique_lock starting(all_started);
    const Workers workers(count, error, [&](int) { const std::lock_guard wait(all_started); });
    starting.unlock();
    return error.status();
}

// oneTBB starts its threads when it first needs them, and leaves work undone where that fails: let it need them now. Waits until
// all take part, or so long that all will have been started.
void start_workers(tbb::task_arena& arena, int count) {
    const auto enough = std::chrono::steady_clock::now() + std::chrono::milliseconds(50);
    std::atomic<int> here{0};
    const auto meet = [&](int) {
        ++here;
        while (here < count && std::chrono::steady_clock::now() < enough) std::this_thread::yield();
    };
    arena.execute([&] { tbb::parallel_for(0, count, meet, tbb::simple_partitioner()); });
}
}  // namespace

struct Threads::Arena {
    // More threads than processors are only granted while a global_control asks for them.
    explicit Arena(int count)
        : control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count)), arena(count) {}
    tbb::global_control control;
    tbb::task_arena arena;
};

int Threads::count_of(int asked) { return asked > 0 ? asked : tbb::info::default_concurrency(); }

Threads::Threads(int count) : count_(count_of(count)) {
    if (const Status started = try_threads(count_ - 1); !started) throw std::runtime_error(started.error().message);
    arena_ = std::make_unique<Arena>(count_);
    start_workers(arena_->arena, count_);
}
Threads::~Threads() = default;

void Threads::run(const std::function<void()>& work) const { arena_->arena.execute(work); }

}  // namespace latent
