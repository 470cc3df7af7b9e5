#include "tools/develop/preview.h"

#include <algorithm>

namespace latent::develop {

Result<std::size_t> runs_within(double seconds, std::size_t runs, const Trial& trial) {
    constexpr double kCaution = 0.8;        // runs differ, and so does a disk from one minute to the next
    constexpr double kTrialShare = 1 / 6.;  // of what is left, for the next trial
    constexpr double kReach = 8;            // a trial says little about many times as many runs
    constexpr double kShare = 1 / 16.;  // of the time of a trial, at least, is taken by its runs; the rest by the picture itself
    if (runs <= 1) return runs;
    const auto whole = [&](double count) { return static_cast<std::size_t>(std::clamp(count, 1.0, static_cast<double>(runs))); };
    double first = 0;  // seconds of one run
    for (std::size_t tried = 1;;) {
        const Result<double> taken = trial(tried);
        if (!taken) return taken.error();
        seconds -= *taken;
        const auto count = static_cast<double>(tried);
        if (tried == 1) first = *taken;
        const double each = tried == 1 ? *taken : std::max((*taken - first) / (count - 1), *taken * kShare / count);
        const auto within = [&](double left) { return count + (left - *taken) / std::max(each, 1e-12); };
        const double possible = within(seconds * kCaution), next = within(seconds * kTrialShare);
        if (possible <= kReach * count || next < 2 * count) return whole(possible);
        if (next >= static_cast<double>(runs)) return runs;
        tried = whole(next);
    }
}

}  // namespace latent::develop
