#include "base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

namespace latent {

struct Threads::Arena {
    // More threads than processors are only granted while a global_control asks for them.
    explicit Arena(int count)
        : control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count)), arena(count) {}
    tbb::global_control control;
    tbb::task_arena arena;
};

Threads::Threads(int count) : count_(count > 0 ? count : tbb::info::default_concurrency()) {
    arena_ = std::make_unique<Arena>(count_);
}
Threads::~Threads() = default;

void Threads::run(const std::function<void()>& work) const { arena_->arena.execute(work); }

}  // namespace latent
