#include "tools/develop/channels/light_groups.h"

#include <algorithm>
#include <cmath>

#include "base/json.h"
#include "color/light_spectrum.h"
#include "sampledb/read/provenance.h"

namespace latent::develop {

using color::Spectrum;

namespace {

std::vector<LightGroup> light_groups_in(std::string_view origin) {
    std::vector<LightGroup> groups;
    for (const sampledb::NamedLights& lights : sampledb::lights_in(origin)) {
        groups.push_back({lights.name});
        LightGroup& out = groups.back();
        const nlohmann::json stored = nlohmann::json::parse(lights.spectrum, nullptr, false);
        if (!stored.is_object()) continue;
        const auto numbers = [&stored](const char* key) {
            std::vector<double> list;
            if (!stored.contains(key) || !stored[key].is_array()) return list;
            for (const nlohmann::json& x : stored[key]) list.push_back(x.is_number() ? x.get<double>() : std::nan(""));
            return list;
        };
        const bool goes_on = stored.value("goes_on", nlohmann::json()) == true;
        Result<Spectrum> spectrum =
            Spectrum::from_samples(numbers("nm"), numbers("value"), goes_on ? color::Outside::kClamped : color::Outside::kZero);
        if (spectrum && color::luminance(*spectrum) > 0) out.spectrum = *std::move(spectrum);
    }
    return groups;
}

Result<std::vector<LightGroup>> named_groups(const sampledb::RunSet& run_set) {
    if (std::ranges::find(run_set.job().extra, kLightGroupColumn, &sampledb::ExtraColumnSpec::name) == run_set.job().extra.end())
        return usage_error("the files have no light groups; render the scene with --light-groups");
    std::vector<LightGroup> groups;
    const auto take = [&](std::string_view origin) {
        if (groups.empty()) groups = light_groups_in(origin);
    };
    if (Status s = for_each_origin(run_set, take); !s) return s.error();
    return groups;
}

}  // namespace

Result<std::vector<LightGroup>> light_groups_of(const sampledb::RunSet& run_set) {
    Result<std::vector<LightGroup>> groups = named_groups(run_set);
    if (!groups || !groups->empty()) return groups;
    for (int i = 0; i < 256; ++i) groups->push_back({std::to_string(i)});
    return groups;
}

Result<std::vector<std::string>> names_of_lights(const sampledb::RunSet& run_set) {
    const Result<std::vector<LightGroup>> groups = named_groups(run_set);
    if (!groups) return groups.error();
    if (groups->empty()) return usage_error("the files do not name their light groups");
    std::vector<std::string> names;
    for (const LightGroup& group : *groups) names.push_back(group.name);
    return names;
}

}  // namespace latent::develop
