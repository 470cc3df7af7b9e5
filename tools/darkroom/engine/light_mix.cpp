#include "tools/darkroom/engine/light_mix.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "tools/develop/channels/light_setting.h"

namespace latent::darkroom {

Result<LightMix> light_mix_of(const Recipe& recipe, const std::vector<std::string>& groups) {
    LightMix mix{recipe, std::vector<double>(groups.size(), 1)};
    if (!recipe.contains("develop")) return mix;
    Recipe& section = mix.of_layers["develop"];
    const Recipe given = section.value("light", Recipe::array());
    for (const char* key : {"light", "denoise", "dim-fireflies", "estimator"}) section.erase(key);
    for (const Recipe& light : given.is_array() ? given : Recipe::array({given})) {
        const Result<develop::LightSetting> setting = develop::parse_light(light.get<std::string>());
        if (!setting) return setting.error();
        const auto group = std::ranges::find(groups, setting->name);
        if (group == groups.end()) return usage_error(fmt::format("--light {}: there is no such group of lights", setting->name));
        mix.factors[static_cast<std::size_t>(group - groups.begin())] *= setting->factor;
        std::string colour = setting->spectrum;
        for (const std::string& curve : setting->curves) colour += (colour.empty() ? "" : ",") + curve;
        if (!colour.empty()) section["light"].push_back(setting->name + "=" + colour);
    }
    return mix;
}

Status add_up(const develop::PixelArray& layers, const std::vector<std::string>& groups, const std::vector<double>& factors,
              develop::PictureSink& sink) {
    constexpr std::size_t kColours = 3;
    image::ExrTileSpec spec = layers.spec();
    const std::vector<std::string> all = spec.channels;
    spec.channels.resize(kColours);
    const std::vector<float> weights(factors.begin(), factors.end());
    std::vector<std::size_t> first;  // channel of each group
    for (const std::string& group : groups) {
        const auto channel = std::ranges::find(all, fmt::format("light.{}.{}", group, all.front()));
        if (channel == all.end()) return Error{ErrorCode::kNotFound, "no layer of the lights " + group};
        first.push_back(static_cast<std::size_t>(channel - all.begin()));
    }
    if (Status s = sink.begin(spec, 0); !s) return s;
    constexpr std::size_t kTile = develop::TileSink::kTile;
    std::vector<float> sum;
    for (std::size_t y0 = 0; y0 < layers.height(); y0 += kTile) {
        for (std::size_t x0 = 0; x0 < layers.width(); x0 += kTile) {
            sum.clear();
            for (std::size_t y = y0; y < std::min(y0 + kTile, layers.height()); ++y) {
                for (std::size_t x = x0; x < std::min(x0 + kTile, layers.width()); ++x) {
                    const float* const pixel = layers.pixels().data() + (y * layers.width() + x) * all.size();
                    for (std::size_t c = 0; c < kColours; ++c) {
                        float value = 0;
                        for (std::size_t g = 0; g < groups.size(); ++g) value += weights[g] * pixel[first[g] + c];
                        sum.push_back(value);
                    }
                }
            }
            if (Status s = sink.write(static_cast<int>(x0 / kTile), static_cast<int>(y0 / kTile), sum); !s) return s;
        }
    }
    return sink.finish();
}

}  // namespace latent::darkroom
