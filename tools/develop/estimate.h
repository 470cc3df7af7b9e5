// tools/develop/estimate.h: what developing costs, found out by developing some of the runs. docs/developing.md, "Forecast".
#pragma once

#include <cstddef>
#include <functional>

#include "base/result.h"

namespace latent::develop {

// Seconds that pass, and seconds that all threads compute.
struct Cost {
    double wall = 0, cpu = 0;

    Cost operator+(const Cost& other) const { return {wall + other.wall, cpu + other.cpu}; }
    Cost operator-(const Cost& other) const { return {wall - other.wall, cpu - other.cpu}; }
    Cost operator*(double factor) const { return {wall * factor, cpu * factor}; }
};
// The larger of both, each by itself.
Cost at_least(const Cost& a, const Cost& b);

// Counts both from its creation.
class CostMeter {
 public:
    CostMeter();
    Cost so_far() const;

 private:
    Cost begin_;
};

// A picture costs something by itself, and each run its share.
struct RunCost {
    Cost picture, run;
    Cost spent;  // by all trials

    Cost of(double runs) const { return picture + run * runs; }
};

// What developing some of the runs costs; measured.
using Trial = std::function<Result<Cost>(std::size_t runs)>;

// Develops one run, then more, up to eight times as many each time, for about `seconds` in all, but at least one run. One trial
// alone cannot tell the picture's cost from the run's: then all of it is taken for the run's. Errors: those of `trial`.
Result<RunCost> measure_runs(double seconds, std::size_t runs, const Trial& trial);

// How many of `runs` can be developed within `seconds`, the trials included; at least one. Errors: those of `trial`.
Result<std::size_t> runs_within(double seconds, std::size_t runs, const Trial& trial);

}  // namespace latent::develop
