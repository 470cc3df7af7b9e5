#include "tools/develop/light_groups.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/json.h"
#include "base/url.h"
#include "color/light_spectrum.h"
#include "sampledb/read/file_reader.h"
#include "sampledb/read/provenance.h"

namespace latent::develop {

using color::Spectrum;

std::vector<LightGroup> light_groups_in(std::string_view provenance_json) {
    std::vector<LightGroup> groups;
    for_each_element(member_of(provenance_json, "light_groups"), [&](std::string_view element) {
        const nlohmann::json group = nlohmann::json::parse(element, nullptr, false);
        LightGroup& out = groups.emplace_back();
        if (!group.is_object() || !group.contains("name") || !group["name"].is_string()) return;
        out.name = group["name"].get<std::string>();
        if (!group.contains("spectrum")) return;
        const auto numbers = [&](const char* key) {
            std::vector<double> list;
            const nlohmann::json& spectrum = group["spectrum"];
            if (!spectrum.is_object() || !spectrum.contains(key) || !spectrum[key].is_array()) return list;
            for (const nlohmann::json& x : spectrum[key]) list.push_back(x.is_number() ? x.get<double>() : std::nan(""));
            return list;
        };
        const bool goes_on = group["spectrum"].is_object() && group["spectrum"].value("goes_on", nlohmann::json()) == true;
        Result<Spectrum> spectrum =
            Spectrum::from_samples(numbers("nm"), numbers("value"), goes_on ? color::Outside::kClamped : color::Outside::kZero);
        if (spectrum && color::luminance(*spectrum) > 0) out.spectrum = *std::move(spectrum);
    });
    for (std::size_t i = 0; i < groups.size(); ++i) {
        if (groups[i].name.empty()) groups[i].name = std::to_string(i);
    }
    return groups;
}

Result<std::vector<LightGroup>> light_groups_of(const sampledb::Gathering& gathering) {
    if (std::ranges::find(gathering.job().extra, kLightGroupColumn, &sampledb::ExtraColumnSpec::name) ==
        gathering.job().extra.end())
        return usage_error("--light: the files have no light groups; render the scene with --light-groups");
    for (const sampledb::SelectedRun& run : gathering.runs()) {
        const std::filesystem::path& path = gathering.files()[run.file];
        const Result<std::shared_ptr<const sampledb::ByteSource>> source = sampledb::open_source(path);
        if (!source) return source.error();
        const Result<sampledb::FileContents> frames = sampledb::read_frames(**source);
        if (!frames) return frames.error().at(shown_name(path));
        const auto own = sampledb::quote_provenance(frames->header.provenance_json, sampledb::kHeaderProvenanceDepth);
        std::vector<LightGroup> groups = light_groups_in(own.json);
        const auto merged = sampledb::quote_provenance(frames->footer_provenance, sampledb::kFooterProvenanceDepth);
        for_each_element(member_of(merged.json, "parts"), [&](std::string_view part) {
            if (groups.empty()) groups = light_groups_in(member_of(part, "provenance"));
        });
        if (!groups.empty()) return groups;
        break;  // all parts of a job say the same
    }
    std::vector<LightGroup> numbered;
    for (int i = 0; i < 256; ++i) numbered.push_back({std::to_string(i)});
    return numbered;
}

}  // namespace latent::develop
