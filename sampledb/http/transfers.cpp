#include "sampledb/http/transfers.h"

#include <system_error>
#include <utility>

namespace latent::sampledb {

Transfers::~Transfers() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    added_.notify_all();
    for (std::thread& thread : threads_) thread.join();
}

void Transfers::add(Transfer transfer, bool urgent) {
    const std::lock_guard lock(mutex_);
    if (idle_ <= urgent_.size() + others_.size() && threads_.size() < connections_) {
        try {
            threads_.emplace_back([this] { work(); });
        } catch (const std::system_error&) {  // the threads that there are do it all
            if (threads_.empty()) throw;
        }
    }
    (urgent ? urgent_ : others_).push_back(std::move(transfer));
    added_.notify_one();
}

void Transfers::work() {
    HttpConnection connection(patience_);
    std::unique_lock lock(mutex_);
    for (;;) {
        ++idle_;
        added_.wait(lock, [this] { return stop_ || !urgent_.empty() || !others_.empty(); });
        --idle_;
        if (stop_) return;
        std::deque<Transfer>& queue = urgent_.empty() ? others_ : urgent_;
        const Transfer transfer = std::move(queue.front());
        queue.pop_front();
        lock.unlock();
        Result<Fetched> fetched = Fetched{};
        const Status status = caught([&]() -> Status {
            fetched =
                connection.get(transfer.url, transfer.offset, transfer.size, transfer.known ? &*transfer.known : nullptr, stop_);
            return {};
        });
        transfer.done(status ? std::move(fetched) : Result<Fetched>(status.error()));
        lock.lock();
    }
}

}  // namespace latent::sampledb
