// render/program/stop_signals.h: the signals that stop latent-render with everything so far committed.
#pragma once

#include <atomic>

namespace latent::render {

// Listens to SIGINT, SIGTERM, SIGUSR1 and SIGUSR2 (by which schedulers announce the end of a job's time), and to SIGHUP where it is
// not ignored from the start, as by nohup. Until the first sample there is nothing to commit: they end the program at once, with a
// line and `status`.
void listen_to_signals(int status);

// From now on they set what is returned.
const std::atomic<bool>& commit_on_signals();

}  // namespace latent::render
