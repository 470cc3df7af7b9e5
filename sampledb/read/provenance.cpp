#include "sampledb/read/provenance.h"

#include <fmt/format.h>

#include "base/json.h"
#include "base/size.h"
#include "sampledb/format/footer.h"

namespace latent::sampledb {

namespace {

constexpr std::size_t kMaxQuoted = 4096;  // bytes of a text that is no JSON

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
    return {json_text(nlohmann::json(stored.substr(0, kMaxQuoted)), -1), objection};
}

void for_each_origin(const FileContents& file, const std::function<void(std::string_view)>& take) {
    const QuotedProvenance own = quote_provenance(file.header.provenance_json, kHeaderProvenanceDepth);
    if (own.objection.empty()) take(own.json);
    const QuotedProvenance merged = quote_provenance(file.footer_provenance, kFooterProvenanceDepth);
    if (!merged.objection.empty()) return;
    for_each_element(member_of(merged.json, "parts"), [&](std::string_view part) { take(member_of(part, "provenance")); });
}

std::optional<Resolution> resolution_in(std::string_view origin) {
    const nlohmann::json pixels = nlohmann::json::parse(member_of(origin, "resolution"), nullptr, false);
    const auto side = [&](std::size_t i) -> std::uint32_t {
        const bool number = pixels.is_array() && pixels.size() == 2 && pixels[i].is_number_unsigned();
        const std::uint64_t value = number ? pixels[i].get<std::uint64_t>() : 0;
        return value <= UINT32_MAX ? static_cast<std::uint32_t>(value) : 0;
    };
    const Resolution found{side(0), side(1)};
    return found.width > 0 && found.height > 0 ? std::optional(found) : std::nullopt;
}

std::vector<NamedLights> lights_in(std::string_view origin) {
    std::vector<NamedLights> groups;
    for_each_element(member_of(origin, "light_groups"), [&](std::string_view group) {
        if (!group.starts_with('{')) group = "{}";
        const nlohmann::json name = nlohmann::json::parse(member_of(group, "name"), nullptr, false);
        groups.push_back({name.is_string() ? name.get<std::string>() : "", std::string(member_of(group, "spectrum"))});
        if (groups.back().name.empty()) groups.back().name = std::to_string(groups.size() - 1);
    });
    return groups;
}

}  // namespace latent::sampledb
