#include "c_api/origin.h"

#include <string_view>

#include "base/json.h"
#include "tools/merge/provenance.h"

namespace latent::c {

namespace {

// Elements that are texts, and the names of those that are objects; "" for others.
std::vector<std::string> names_in(std::string_view array) {
    std::vector<std::string> names;
    for_each_element(array, [&](std::string_view element) {
        if (element.starts_with('{')) element = member_of(element, "name");
        const nlohmann::json name = nlohmann::json::parse(element, nullptr, false);
        names.push_back(name.is_string() ? name.get<std::string>() : "");
    });
    return names;
}

}  // namespace

Result<Origin> origin_of(const sampledb::RunSet& run_set) {
    Result<std::string> json = merge::provenance_of(run_set);
    if (!json) return json.error();
    Origin origin{std::move(*json), {}, {}};
    for_each_element(member_of(origin.json, "parts"), [&](std::string_view part) {
        const std::string_view own = member_of(part, "provenance");
        if (!own.starts_with('{')) return;
        if (origin.light_groups.empty()) origin.light_groups = names_in(member_of(own, "light_groups"));
        if (origin.materials.empty()) origin.materials = names_in(member_of(own, "materials"));
    });
    return origin;
}

}  // namespace latent::c
