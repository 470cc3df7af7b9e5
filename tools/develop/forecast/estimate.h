// tools/develop/forecast/estimate.h: what developing costs, found out by developing some of the runs. docs/developing.md,
// "Forecast".
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

#include "base/result.h"

namespace latent::develop {

// Seconds that pass, seconds that all threads compute, and seconds that the measuring thread is ready to compute while other
// programs do. `serial`: those of `cpu` that threads cannot share.
struct Cost {
    double wall = 0, cpu = 0, queued = 0, serial = 0;

    Cost operator+(const Cost& other) const {
        return {wall + other.wall, cpu + other.cpu, queued + other.queued, serial + other.serial};
    }
    Cost operator-(const Cost& other) const { return *this + other * -1; }
    Cost operator*(double factor) const { return {wall * factor, cpu * factor, queued * factor, serial * factor}; }

    double alone() const { return std::max(0.0, wall - queued); }  // seconds that pass if no other program computes
    // What one thread has waited for anything but a processor: for files.
    double waiting() const { return std::max(0.0, wall - cpu - queued); }
};
// The larger, or smaller, of each.
Cost at_least(const Cost& a, const Cost& b);
Cost at_most(const Cost& a, const Cost& b);

// Counts from its creation, in one thread. Where the system does not say how long threads were queued, nothing counts as that.
class CostMeter {
 public:
    CostMeter();
    Cost so_far() const;

 private:
    Cost begin_;
};

// Some work, in any unit, and what it cost; `known` of that is not asked for.
struct Tried {
    double amount = 0;
    Cost cost, known = {};
};
// Does about `amount` of the work, to see what it costs.
using Trial = std::function<Result<Tried>(double amount)>;

struct LinearCost {
    Cost fixed, each;  // in any case; for each unit of the work
    Cost spent;        // by all trials

    Cost of(double amount) const { return fixed + each * amount; }
};

// Tries `least`, then more: each amount is up to 64 times the last, and at most `most`. Ends after about `seconds`, or up to
// twice that if other programs have the processor meanwhile, or when an amount costs `enough` seconds of CPU time more than the
// first. The cheapest of two tries of an amount counts, or of four of the last; `least` is tried once where time is short, and if
// there was no time for more, all of its cost is taken to be that of its amount. `known_of_most`: Tried::known of the largest
// amount, in seconds. Errors: those of `trial`.
Result<LinearCost> measure(double seconds, double least, double most, double enough, const Trial& trial, double known_of_most = 0);

// The share of a processor that each of so many threads gets beside the other programs on this machine (0..1], found out by
// computing for 0.3 s.
double processor_share(int threads);

// Seconds that pass when so many threads, with that share of a processor each, do what cost one thread `cost`.
double seconds_with(const Cost& cost, int threads, double share);

// How many of `runs` can be developed within `seconds`, the trials included; at least one, if there is any. The amount is that of
// runs. Errors: those of `trial`.
Result<std::size_t> runs_within(double seconds, std::size_t runs, const Trial& trial);

}  // namespace latent::develop
