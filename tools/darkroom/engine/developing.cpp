#include "tools/darkroom/engine/developing.h"

#include <algorithm>
#include <utility>

namespace latent::darkroom {

namespace {

constexpr std::chrono::milliseconds kLook = std::chrono::milliseconds(20);  // how often those who wait look whether they still do
constexpr std::chrono::milliseconds kGrace = std::chrono::milliseconds(1000);  // for who comes back, with another print of the same

}  // namespace

Developing::~Developing() {
    {
        const std::scoped_lock lock(mutex_);
        ends_ = true;
    }
    changed_.notify_all();
    worker_.join();
}

Developing::Made Developing::wait_for(const std::string& key, Work work, const Stopped& stopped) {
    std::unique_lock lock(mutex_);
    const auto is_it = [&](const std::shared_ptr<Job>& job) { return job && job->key == key && !job->given_up; };
    const auto found = std::ranges::find_if(queue_, is_it);
    std::shared_ptr<Job> job = is_it(running_) ? running_ : found != queue_.end() ? *found : nullptr;
    if (!job) {
        job = std::make_shared<Job>();
        job->key = key;
        job->work = std::move(work);
        queue_.push_back(job);
        changed_.notify_all();
    }
    ++job->waiting;
    while (!job->made && !ends_ && !is_true(stopped)) changed_.wait_for(lock, kLook);
    --job->waiting;
    job->left = Clock::now();
    if (job->made) return *job->made;
    if (job->waiting == 0) std::erase(queue_, job);
    return given_up();
}

bool Developing::is_unwanted(Job& job) {
    if (job.given_up) return true;
    if (job.waiting > 0 && !ends_) return false;
    const std::scoped_lock lock(mutex_);
    if (ends_ || (job.waiting == 0 && (!queue_.empty() || Clock::now() - job.left > kGrace))) job.given_up = true;
    return job.given_up;
}

void Developing::run() {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [this] { return ends_ || !queue_.empty(); });
        if (ends_) return;
        running_ = std::move(queue_.front());
        queue_.pop_front();
        Job& job = *running_;
        lock.unlock();
        std::optional<Made> made;
        try {
            made = job.work([this, &job] { return is_unwanted(job); });
        } catch (...) {
            made = current_error();
        }
        lock.lock();
        job.made = std::move(made);
        running_ = nullptr;
        changed_.notify_all();
    }
}

}  // namespace latent::darkroom
