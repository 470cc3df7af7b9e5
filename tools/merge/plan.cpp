#include "tools/merge/plan.h"

#include <algorithm>

#include "tools/merge/compact_groups.h"

namespace latent::merge {

using namespace sampledb;

namespace {

bool same_run(const RunSet& a, std::uint32_t a_run, const RunSet& b, std::uint32_t b_run) {
    const SelectedRun& x = a.runs()[a_run];
    const SelectedRun& y = b.runs()[b_run];
    return x.offset == y.offset && x.header == y.header && a.files()[x.file] == b.files()[y.file];
}

}  // namespace

std::vector<Step> make_plan(const RunSet& run_set, bool compact, std::uint64_t memory) {
    std::vector<Step> plan;
    std::uint32_t next = 0;
    const auto copy_up_to = [&](std::size_t end) {
        for (; next < end; ++next) plan.push_back({next, next + 1});
    };
    for (const CompactGroup& group : compact ? compact_groups(run_set, memory) : std::vector<CompactGroup>{}) {
        copy_up_to(group.first);
        next = static_cast<std::uint32_t>(group.end);
        plan.push_back({static_cast<std::uint32_t>(group.first), next});
    }
    copy_up_to(run_set.runs().size());
    return plan;
}

std::size_t same_steps(const RunSet& a, const std::vector<Step>& a_plan, const RunSet& b, const std::vector<Step>& b_plan) {
    const auto same = [&](const Step& x, const Step& y) {
        if (x.end - x.first != y.end - y.first) return false;
        for (std::uint32_t i = 0; i < x.end - x.first; ++i) {
            if (!same_run(a, x.first + i, b, y.first + i)) return false;
        }
        return true;
    };
    return static_cast<std::size_t>(std::ranges::mismatch(a_plan, b_plan, same).in1 - a_plan.begin());
}

}  // namespace latent::merge
