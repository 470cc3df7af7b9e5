#include "sampledb/read/origin.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "base/json.h"

namespace latent::sampledb {

namespace {

using Member = std::pair<std::string_view, std::string_view>;  // name as it is written, value

std::vector<Member> members_of(std::string_view object) {
    std::vector<Member> members;
    for_each_member(object, [&](std::string_view name, std::string_view value) { members.emplace_back(name, value); });
    return members;
}

std::string object_of(const std::vector<Member>& members) {
    std::string text = "{";
    for (const auto& [name, value] : members)
        fmt::format_to(std::back_inserter(text), "{}\"{}\":{}", text.size() > 1 ? "," : "", name, value);
    return text + "}";
}

double cpu_seconds_in(std::string_view provenance) {
    const std::string_view text = member_of(provenance, "cpu_seconds");
    double seconds = 0;
    const bool is_number = std::from_chars(text.data(), text.data() + text.size(), seconds).ec == std::errc();
    return is_number && seconds > 0 ? seconds : 0;
}

std::uint64_t committed_before(std::string_view provenance) {
    const std::string_view text = member_of(provenance, "committed_before");
    std::uint64_t samples = 0;
    const bool is_number = std::from_chars(text.data(), text.data() + text.size(), samples).ec == std::errc();
    return is_number ? samples : 0;
}

void add_time(std::string_view provenance, Origin& origin) {
    const double seconds = cpu_seconds_in(provenance);
    origin.cpu_seconds += seconds;
    origin.all_timed = origin.all_timed && seconds > 0;
    origin.committed_before += committed_before(provenance);
}

// The members of the first that all have with the same value.
std::vector<Member> common_members(const std::vector<std::string_view>& objects) {
    std::vector<Member> common = members_of(objects.front());
    for (const std::string_view object : objects) {
        const std::vector<Member> members = members_of(object);
        const std::map<std::string_view, std::string_view> values(members.begin(), members.end());
        std::erase_if(common, [&](const Member& member) {
            const auto at = values.find(member.first);
            return at == values.end() || at->second != member.second;
        });
    }
    return common;
}

}  // namespace

QuotedProvenance own_provenance(const FileContents& file) {
    QuotedProvenance own = quote_provenance(file.header.provenance_json, kHeaderProvenanceDepth);
    const QuotedProvenance footer = quote_provenance(file.footer_provenance, kFooterProvenanceDepth);
    const std::vector<Member> more = members_of(footer.objection.empty() ? member_of(footer.json, "finished") : "");
    if (!own.objection.empty() || more.empty()) return own;
    std::vector<Member> members = members_of(own.json);
    members.insert(members.end(), more.begin(), more.end());
    return {object_of(members), ""};
}

Origin origin_of(const FileContents& file) {
    Origin origin{.all_timed = true};
    const QuotedProvenance footer = quote_provenance(file.footer_provenance, kFooterProvenanceDepth);
    std::vector<std::string_view> samples, provenances;
    if (footer.objection.empty()) {
        for_each_element(member_of(footer.json, "parts"), [&](std::string_view part) {
            samples.push_back(member_of(part, "samples"));
            provenances.push_back(member_of(part, "provenance"));
        });
    }
    if (provenances.empty()) {
        origin.common = own_provenance(file).json;
        if (!footer.objection.empty()) origin.parts = footer.json;
        add_time(origin.common, origin);
        return origin;
    }
    const std::vector<Member> common = common_members(provenances);
    origin.common = object_of(common);
    origin.part_count = provenances.size();
    origin.incomplete = member_of(footer.json, "incomplete") == "true";
    origin.parts = "[";
    for (std::size_t i = 0; i < provenances.size(); ++i) {
        add_time(provenances[i], origin);
        std::vector<Member> differences = members_of(provenances[i]);
        std::erase_if(differences, [&](const Member& member) { return std::ranges::find(common, member) != common.end(); });
        const bool is_object = provenances[i].starts_with('{');
        fmt::format_to(std::back_inserter(origin.parts), R"({}{{"samples":{},"differences":{}}})", i > 0 ? "," : "",
                       samples[i].empty() ? "[]" : samples[i],
                       is_object                ? object_of(differences)
                       : provenances[i].empty() ? "{}"
                                                : std::string(provenances[i]));
    }
    origin.parts += "]";
    return origin;
}

}  // namespace latent::sampledb
