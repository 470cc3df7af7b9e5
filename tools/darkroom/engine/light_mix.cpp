#include "tools/darkroom/engine/light_mix.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/develop/channels/light_setting.h"

namespace latent::darkroom {

std::string LightMix::key() const {
    const auto section = of_groups.find("develop");
    const nlohmann::json sorted = section == of_groups.end() ? nlohmann::json::object() : nlohmann::json(*section);
    return fmt::format("{} {}", sorted.dump(-1, ' ', true), fmt::join(lights, " "));
}

Result<LightMix> light_mix_of(const Recipe& recipe, const std::vector<std::string>& groups) {
    LightMix mix{recipe, {}, std::vector<double>(groups.size(), 1)};
    std::vector<std::string> colours(groups.size());
    if (mix.of_groups.contains("develop")) {
        Recipe& section = mix.of_groups["develop"];
        if (section.contains("light")) {
            const Recipe given = section["light"].is_array() ? section["light"] : Recipe::array({section["light"]});
            for (const Recipe& light : given) {
                const Result<develop::LightSetting> setting = develop::parse_light(light.get<std::string>());
                if (!setting) return setting.error();
                for (std::size_t i = 0; i < groups.size(); ++i) {
                    if (groups[i] != setting->name) continue;
                    mix.factors[i] *= setting->factor;
                    for (const std::string& curve : setting->curves) colours[i] += "," + curve;
                    if (!setting->spectrum.empty()) colours[i] += "," + setting->spectrum;
                }
            }
        }
        for (const char* key : {"light", "denoise", "dim-fireflies", "estimator", "size", "crop", "mipmap", "compression"})
            section.erase(key);
    }
    for (std::size_t alone = 0; alone < groups.size(); ++alone) {
        std::vector<std::string> lights;
        for (std::size_t i = 0; i < groups.size(); ++i) {
            if (i != alone) lights.push_back(groups[i] + "=0");
            if (i == alone && !colours[i].empty()) lights.push_back(groups[i] + "=" + colours[i].substr(1));
        }
        mix.lights.push_back(std::move(lights));
    }
    return mix;
}

Status add_up(const std::vector<LinearPicture>& groups, const std::vector<double>& factors, develop::PictureSink& sink) {
    if (Status s = sink.begin(groups.front().spec(), 0); !s) return s;
    for (const auto& [place, first] : groups.front().tiles()) {
        std::vector<float> sum(first.size());
        for (std::size_t g = 0; g < groups.size(); ++g) {
            const std::vector<float>& pixels = groups[g].tiles().at(place);
            const auto factor = static_cast<float>(factors[g]);
            for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += factor * pixels[i];
        }
        if (Status s = sink.write(place.first, place.second, sum); !s) return s;
    }
    return sink.finish();
}

}  // namespace latent::darkroom
