#include "sampledb/data/parse.h"

#include <charconv>
#include <string>

#include "base/parse.h"

namespace latent::sampledb {

Result<SampleRange> parse_sample_range(std::string_view text) {
    const auto ends = parse_pair(text, ':');
    if (ends && ends->first < ends->second) return SampleRange{ends->first, ends->second};
    return is_not(text, "a range of samples (try 0:1M; A:B means samples A to B-1)");
}

Result<JobId> parse_job_id(std::string_view text) {
    JobId id;
    const auto parse = [](std::string_view digits, std::uint64_t& into) {
        const auto [end, error] = std::from_chars(digits.begin(), digits.end(), into, 16);
        return error == std::errc() && end == digits.end();
    };
    if (text.size() != 32 || !parse(text.substr(0, 16), id.high) || !parse(text.substr(16), id.low)) {
        return is_not(text, "a job id (32 hexadecimal digits)");
    }
    return id;
}

}  // namespace latent::sampledb
