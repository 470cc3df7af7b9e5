// tools/darkroom/engine/light_mix.h: a light mix as a sum of layers, each of the light of one group.
#pragma once

#include <string>
#include <vector>

#include "base/recipe.h"
#include "base/result.h"
#include "tools/develop/picture/pixel_array.h"

namespace latent::darkroom {

struct LightMix {
    Recipe of_layers;             // with lights of other colours, but as bright as they were; without what a sum cannot show
    std::vector<double> factors;  // one for each group
};

// Errors: kUsage, of what the recipe says about lights.
Result<LightMix> light_mix_of(const Recipe& recipe, const std::vector<std::string>& groups);

// Adds up the layers light.GROUP of a picture. Last digits can differ from those of a picture of all lights.
Status add_up(const develop::PixelArray& layers, const std::vector<std::string>& groups, const std::vector<double>& factors,
              develop::PictureSink& sink);

}  // namespace latent::darkroom
