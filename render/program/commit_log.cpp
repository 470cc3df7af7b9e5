#include "render/program/commit_log.h"

#include <fmt/format.h>

#include "base/size.h"

namespace latent::render {

std::string CommitLog::line(const Committed& committed, Clock::time_point now, bool final) {
    if (committed.samples == said_ || (!final && last_ && now - *last_ < interval_)) return "";
    said_ = committed.samples;
    last_ = now;
    std::string line = fmt::format("committed {} of {} samples ({:.1f} %)", committed.samples, range_,
                                   100 * static_cast<double>(committed.samples) / static_cast<double>(range_));
    if (!(committed.samples_per_second > 0)) return line;
    const double left = static_cast<double>(range_ - committed.samples) / committed.samples_per_second;
    if (left > 0) line += fmt::format(", {} left", format_duration(left));
    return line +
           fmt::format(", {} samples/s, {} written", format_count(committed.samples_per_second), format_size(committed.bytes));
}

}  // namespace latent::render
