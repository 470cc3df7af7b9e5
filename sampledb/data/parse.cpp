#include "sampledb/data/parse.h"

#include <charconv>
#include <string>

#include "base/size.h"

namespace latent::sampledb {

Result<SampleRange> parse_sample_range(std::string_view text) {
    const std::size_t colon = text.find(':');
    const Error wrong{ErrorCode::kUsage, "'" + std::string(text) + "' is no range of samples; A:B means samples A .. B-1"};
    if (colon == std::string_view::npos) return wrong;
    const Result<std::uint64_t> first = parse_size(text.substr(0, colon)), end = parse_size(text.substr(colon + 1));
    if (!first || !end || *end <= *first) return wrong;
    return SampleRange{*first, *end};
}

Result<JobId> parse_job_id(std::string_view text) {
    JobId id;
    const auto parse = [](std::string_view digits, std::uint64_t& into) {
        const auto [end, error] = std::from_chars(digits.begin(), digits.end(), into, 16);
        return error == std::errc() && end == digits.end();
    };
    if (text.size() != 32 || !parse(text.substr(0, 16), id.high) || !parse(text.substr(16), id.low)) {
        return Error{ErrorCode::kUsage, "'" + std::string(text) + "' is no job id: 32 hexadecimal digits"};
    }
    return id;
}

}  // namespace latent::sampledb
