// base/in_order.h: pieces are made by many threads and taken one by one in their order.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/result.h"

namespace latent {

inline constexpr std::size_t kPiecesPerThread = 2;  // that exist at once
inline std::size_t pieces_at_once() { return kPiecesPerThread * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()); }

// For i = 0 .. count-1: `make(i)` on any thread, then `take(i, piece)` on one thread at a time, in the order of i. make(i) begins
// when piece i - `live` has been taken. The first error ends it: later pieces are not taken. A thread that has nothing to
// do sleeps, where a tbb::parallel_pipeline would spin.
template <class Make, class Take>
Status make_in_order(std::size_t count, const Make& make, const Take& take, std::size_t live = pieces_at_once()) {
    using Made = std::invoke_result_t<Make, std::size_t>;  // Result<T>
    std::vector<std::optional<Made>> made(live);
    std::mutex mutex;
    std::condition_variable changed;
    std::size_t begun = 0, taken = 0;
    bool taking = false;
    Status status;
    const auto work = [&](int) {
        std::unique_lock lock(mutex);
        while (true) {
            changed.wait(lock, [&] { return begun == count || begun < taken + live || !status; });
            if (begun == count || !status) return;
            const std::size_t i = begun++;
            lock.unlock();
            // Isolated: while it waits for tasks of its own, a thread must not begin a piece that waits for this one.
            std::optional<Made> piece;
            try {
                tbb::this_task_arena::isolate([&] { piece.emplace(make(i)); });
            } catch (...) {
                piece.emplace(current_error());
            }
            lock.lock();
            made[i % live] = std::move(piece);
            if (taking) continue;
            taking = true;
            while (status && taken < begun && made[taken % live]) {
                std::optional<Made> next = std::exchange(made[taken % live], std::nullopt);
                lock.unlock();
                const Status done = caught([&]() -> Status {
                    if (!*next) return next->error();
                    Status s;
                    tbb::this_task_arena::isolate([&] { s = take(taken, std::move(**next)); });
                    return s;
                });
                lock.lock();
                ++taken;
                if (!done) status = done;
                changed.notify_all();
            }
            taking = false;
        }
    };
    tbb::parallel_for(0, tbb::this_task_arena::max_concurrency(), work, tbb::simple_partitioner());
    return status;
}

}  // namespace latent
