// sampledb/http/transfers.h: many ranges of remote files at a time, each over one of a few connections.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "sampledb/http/http_connection.h"

namespace latent::sampledb {

struct Transfer {
    std::string url;
    std::uint64_t offset = 0, size = 0;
    std::optional<RemoteVersion> known;         // HttpConnection::get
    std::function<void(Result<Fetched>)> done;  // called by a thread of its own
};

class Transfers {
 public:
    Transfers(std::size_t connections, const Patience& patience) : connections_(connections), patience_(patience) {}
    // Gives up what is on its way; what waits is never begun.
    ~Transfers();

    // `urgent`: a caller waits for it; comes before those that are not.
    void add(Transfer transfer, bool urgent);

 private:
    void work();

    const std::size_t connections_;
    const Patience patience_;
    std::atomic<bool> stop_ = false;
    std::mutex mutex_;
    std::condition_variable added_;
    std::deque<Transfer> urgent_, others_;
    std::size_t idle_ = 0;
    std::vector<std::thread> threads_;
};

}  // namespace latent::sampledb
