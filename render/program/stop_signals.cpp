#include "render/program/stop_signals.h"

#include <unistd.h>

#include <csignal>
#include <string_view>

namespace latent::render {

namespace {

std::atomic<bool> rendering{false}, stop_requested{false};
int status_before = 0;  // the first sample

void request_stop(int) {
    static constexpr std::string_view kLine = "latent-render: stopped before the first sample; run the same command again\n";
    if (!rendering) {
        [[maybe_unused]] const ssize_t told = ::write(STDERR_FILENO, kLine.data(), kLine.size());
        ::_exit(status_before);
    }
    stop_requested = true;
}

}  // namespace

void listen_to_signals(int status) {
    status_before = status;
    struct sigaction action = {}, at_start = {};
    action.sa_handler = request_stop;
    for (const int signal : {SIGINT, SIGTERM, SIGUSR1, SIGUSR2}) ::sigaction(signal, &action, nullptr);
    ::sigaction(SIGHUP, nullptr, &at_start);
    if (at_start.sa_handler != SIG_IGN) ::sigaction(SIGHUP, &action, nullptr);
}

const std::atomic<bool>& commit_on_signals() {
    rendering = true;
    return stop_requested;
}

}  // namespace latent::render
