#include "tools/develop/engine/subset.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/bytes.h"
#include "base/hash.h"

namespace latent::develop {

using sampledb::SampleRange;
using sampledb::SelectedRun;

std::vector<std::uint32_t> shuffled_runs(const sampledb::RunSet& all) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
    for (std::uint32_t i = 0; i < all.runs().size(); ++i) {
        std::byte first[8];
        store_le(first, all.runs()[i].header.samples.first);
        keys.emplace_back(hash64(first), i);
    }
    std::ranges::sort(keys);
    std::vector<std::uint32_t> order;
    for (const auto& [key, run] : keys) order.push_back(run);
    return order;
}

std::size_t count_for(const sampledb::RunSet& all, const std::vector<std::uint32_t>& order, double fraction) {
    const double wanted = fraction * static_cast<double>(all.coverage().size());
    double held = 0;
    std::size_t count = 0;
    while (count < order.size() && (count == 0 || held < wanted))
        held += static_cast<double>(all.runs()[order[count++]].coverage.size());
    return count;
}

Subset::Subset(const sampledb::RunSet& all, std::vector<std::uint32_t> runs)
    : RunSetView(all), numbers_(std::move(runs)), read_before_(all.bytes_read()) {
    std::ranges::sort(numbers_);  // as a run set's runs are
    std::vector<SampleRange> ranges;
    for (const std::uint32_t number : numbers_) {
        const SelectedRun& run = all.runs()[number];
        runs_.push_back(run);
        ranges.insert(ranges.end(), run.coverage.ranges().begin(), run.coverage.ranges().end());
    }
    coverage_ = sampledb::Coverage::of(std::move(ranges));
}

}  // namespace latent::develop
