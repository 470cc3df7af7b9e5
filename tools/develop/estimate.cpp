#include "tools/develop/estimate.h"

#include <algorithm>
#include <chrono>
#include <ctime>

namespace latent::develop {

namespace {

Cost now() {
    const auto wall = std::chrono::steady_clock::now().time_since_epoch();
    timespec cpu{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
    return {std::chrono::duration<double>(wall).count(), static_cast<double>(cpu.tv_sec) + 1e-9 * static_cast<double>(cpu.tv_nsec)};
}

}  // namespace

Cost at_least(const Cost& a, const Cost& b) { return {std::max(a.wall, b.wall), std::max(a.cpu, b.cpu)}; }

CostMeter::CostMeter() : begin_(now()) {}
Cost CostMeter::so_far() const { return now() - begin_; }

Result<RunCost> measure_runs(double seconds, std::size_t runs, const Trial& trial) {
    constexpr double kMaxGrowth = 8;
    RunCost cost;
    Cost first;
    for (std::size_t tried = 1;;) {
        const Result<Cost> taken = trial(tried);
        if (!taken) return taken.error();
        cost.spent = cost.spent + *taken;
        const auto count = static_cast<double>(tried);
        if (tried == 1) {
            first = cost.run = *taken;
        } else {
            cost.run = at_least((*taken - first) * (1 / (count - 1)), {});
            cost.picture = at_least(*taken - cost.run * count, {});
        }
        const double left = seconds - cost.spent.wall;
        const double affordable = (left - cost.picture.wall) / std::max(cost.run.wall, 1e-12);
        const double next = std::min({kMaxGrowth * count, affordable, static_cast<double>(runs)});
        if (next < 2 * count) return cost;
        tried = static_cast<std::size_t>(next);
    }
}

Result<std::size_t> runs_within(double seconds, std::size_t runs, const Trial& trial) {
    constexpr double kTrials = 0.25;  // of the time
    constexpr double kCaution = 0.8;  // runs differ, and so does a disk from one minute to the next
    if (runs <= 1) return runs;
    const Result<RunCost> cost = measure_runs(kTrials * seconds, runs, trial);
    if (!cost) return cost.error();
    const double left = kCaution * (seconds - cost->spent.wall);
    const double count = (left - cost->picture.wall) / std::max(cost->run.wall, 1e-12);
    return static_cast<std::size_t>(std::clamp(count, 1.0, static_cast<double>(runs)));
}

}  // namespace latent::develop
