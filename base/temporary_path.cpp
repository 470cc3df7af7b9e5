#include "base/temporary_path.h"

#include <chrono>
#include <csignal>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include "base/parallel.h"

namespace latent {

namespace fs = std::filesystem;

namespace {

struct Registry {
    std::recursive_mutex mutex;
    std::set<fs::path> paths;
};

// Never destroyed: a signal may come at the very end.
Registry& registry() {
    static auto* const registry = new Registry;
    return *registry;
}

// Other threads may still be adding to a folder.
void remove_wholly(const fs::path& path) {
    constexpr int kTries = 1000;
    std::error_code ignored;
    for (int i = 0; i < kTries && fs::exists(fs::symlink_status(path, ignored)); ++i) fs::remove_all(path, ignored);
}

void wait_for(sigset_t signals) {
    int signal = 0;
    if (::sigwait(&signals, &signal) != 0) return;
    registry().mutex.lock();
    remove_temporaries();
    ::pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
    ::raise(signal);
}

}  // namespace

TemporaryPath::TemporaryPath(fs::path path) : path_(std::move(path)) {
    const auto held = hold_signals();
    registry().paths.insert(path_);
}

TemporaryPath::TemporaryPath(TemporaryPath&& other) noexcept : path_(std::exchange(other.path_, {})) {}

TemporaryPath& TemporaryPath::operator=(TemporaryPath&& other) noexcept {
    TemporaryPath old(std::move(*this));
    path_ = std::exchange(other.path_, {});
    return *this;
}

TemporaryPath::~TemporaryPath() {
    if (path_.empty()) return;
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    const auto held = hold_signals();
    registry().paths.erase(path_);
}

// The lock is never returned. Should its owner have been ended by an exception, it stays taken: then there is no lock.
void remove_temporaries() {
    constexpr int kTries = 100;
    for (int i = 0; i < kTries && !registry().mutex.try_lock(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    for (const fs::path& path : registry().paths) remove_wholly(path);
}

void remove_temporaries_on_signals() {
    sigset_t signals;
    ::sigemptyset(&signals);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction action;
        if (::sigaction(signal, nullptr, &action) == 0 && action.sa_handler != SIG_IGN) ::sigaddset(&signals, signal);
    }
    ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // the threads to come inherit it
    Result<std::thread> waiting = start_thread([signals] { wait_for(signals); });
    if (!waiting) throw std::runtime_error(waiting.error().message);
    waiting->detach();
}

std::unique_lock<std::recursive_mutex> hold_signals() { return std::unique_lock(registry().mutex); }

}  // namespace latent
