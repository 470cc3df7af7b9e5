#include "sampledb/read/provenance.h"

#include <fmt/format.h>

#include "base/json.h"
#include "base/size.h"
#include "sampledb/format/footer.h"

namespace latent::sampledb {

namespace {

constexpr std::size_t kMostQuoted = 4096;  // bytes of a text that is no JSON

}  // namespace

QuotedProvenance quote_provenance(std::string_view stored, std::size_t depth) {
    if (stored.empty()) return {"{}", ""};
    std::string objection;
    if (stored.size() > kMaxFooterProvenance) {
        objection = fmt::format("is longer than {}", format_size(kMaxFooterProvenance));
    } else if (const Status s = check_json_object(stored, depth); !s) {
        objection = s.error().message;
    } else {
        return {std::string(stored), ""};
    }
    return {json_text(nlohmann::json(stored.substr(0, kMostQuoted)), -1), objection};
}

}  // namespace latent::sampledb
