#include "tools/develop/forecast/estimate.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <thread>
#include <vector>

#include "base/stopwatch.h"

namespace latent::develop {

namespace {

// /proc/thread-self/schedstat: nanoseconds on a processor, nanoseconds ready for one, and a count (proc(5)).
double seconds_queued() {
    std::ifstream file("/proc/thread-self/schedstat");
    double computed = 0, queued = 0;
    return file >> computed >> queued ? 1e-9 * queued : 0;
}

Cost now() {
    const auto wall = std::chrono::steady_clock::now().time_since_epoch();
    timespec cpu{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
    return {std::chrono::duration<double>(wall).count(), static_cast<double>(cpu.tv_sec) + 1e-9 * static_cast<double>(cpu.tv_nsec),
            seconds_queued()};
}

}  // namespace

Cost at_least(const Cost& a, const Cost& b) {
    return {std::max(a.wall, b.wall), std::max(a.cpu, b.cpu), std::max(a.queued, b.queued), std::max(a.serial, b.serial)};
}
Cost at_most(const Cost& a, const Cost& b) {
    return {std::min(a.wall, b.wall), std::min(a.cpu, b.cpu), std::min(a.queued, b.queued), std::min(a.serial, b.serial)};
}

CostMeter::CostMeter() : begin_(now()) {}
Cost CostMeter::so_far() const { return now() - begin_; }

Result<LinearCost> measure(double seconds, double least, double most, double enough, const Trial& trial, double known_of_most) {
    constexpr double kMaxGrowth = 64;
    constexpr double kUncertain = 0.05, kDoubtful = 0.3;  // relative errors: of known values, of measured ones
    constexpr std::size_t kRepeats = 2, kLastRepeats = 4;
    LinearCost cost;
    Tried first, last;
    std::vector<Tried> repeated;  // the last amount, the cheaper first
    for (double amount = std::min(least, most);;) {
        const Result<Tried> tried = trial(amount);
        if (!tried) return tried.error();
        cost.spent = cost.spent + tried->cost;
        repeated.push_back({tried->amount, at_least(tried->cost - tried->known, {})});
        std::ranges::sort(repeated, {}, [](const Tried& t) { return t.cost.cpu; });
        last = repeated.front();
        // While other programs had the processor, nothing was measured; but nobody waits for ever.
        const double left = std::min(seconds - (cost.spent.wall - cost.spent.queued), 2 * seconds - cost.spent.wall);
        const bool is_first = first.amount == 0 || last.amount == first.amount;
        const bool is_alone = repeated.size() == 1;  // its memory was new, which may cost as much again, or twice
        if (is_alone && (is_first ? tried->cost.wall < left / 10 : tried->cost.alone() < seconds)) continue;
        cost.each = last.amount > 0 ? last.cost * (1 / last.amount) : Cost{};
        if (last.amount > first.amount && first.amount > 0) {
            const Cost slope = (last.cost - first.cost) * (1 / (last.amount - first.amount));
            cost.each = at_least(at_most(slope, cost.each), {});
        } else {
            first = last;
        }
        cost.fixed = at_least(last.cost - cost.each * last.amount, {});
        const double known = tried->known.alone(), more_known = std::max(known_of_most - known, 0.0) / std::max(most - amount, 1.0);
        const auto affordable = [&](double tries) {
            const double at_least_each = (kUncertain * known + kDoubtful * last.cost.alone()) / amount;
            const double each = std::max({cost.each.alone(), at_least_each, 1e-12}) + more_known;
            const double count = (left / tries - known + more_known * amount - cost.fixed.alone()) / each;
            return std::min({kMaxGrowth * amount, count, most});
        };
        double next = affordable(kRepeats + 1);
        if (is_first && next < 2 * amount) next = affordable(1.5);  // a second amount is worth more than repeats
        if (next > amount && next >= 2 * amount && last.cost.cpu - first.cost.cpu < enough) {
            amount = next;
            repeated.clear();
        } else if (repeated.size() == kLastRepeats || (left < tried->cost.wall && !(is_alone && tried->cost.alone() < seconds))) {
            return cost;
        }
    }
}

double processor_share(int threads) {
    constexpr double kSeconds = 0.3;
    const CostMeter meter;
    const Stopwatch stopwatch;
    std::vector<std::jthread> all;
    for (int i = 0; i < threads; ++i) {
        all.emplace_back([&stopwatch] {
            while (stopwatch.seconds() < kSeconds) {
            }
        });
    }
    all.clear();
    const Cost cost = meter.so_far();
    return std::clamp(cost.cpu / (cost.wall * threads), 0.01, 1.0);
}

double seconds_with(const Cost& cost, int threads, double share) {
    return std::max(cost.cpu / threads, cost.serial) / share + cost.waiting();
}

Result<std::size_t> runs_within(double seconds, std::size_t runs, const Trial& trial) {
    constexpr double kTrials = 0.25;  // share of the time
    constexpr double kCaution = 0.8;  // runs differ, and so does a disk from one minute to the next
    if (runs <= 1) return runs;
    const Result<LinearCost> cost = measure(kTrials * seconds, 1, static_cast<double>(runs), kTrials * seconds, trial);
    if (!cost) return cost.error();
    const double left = kCaution * (seconds - cost->spent.wall);
    const double count = (left - cost->fixed.wall) / std::max(cost->each.wall, 1e-12);
    return static_cast<std::size_t>(std::clamp(count, 1.0, static_cast<double>(runs)));
}

}  // namespace latent::develop
