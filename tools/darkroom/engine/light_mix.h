// tools/darkroom/engine/light_mix.h: a light mix as a sum of pictures, each of the light of one group.
#pragma once

#include <string>
#include <vector>

#include "base/recipe.h"
#include "base/result.h"
#include "tools/darkroom/engine/kept_picture.h"

namespace latent::darkroom {

struct LightMix {
    Recipe of_groups;                              // `recipe` as far as a sum can show it, without lights
    std::vector<std::vector<std::string>> lights;  // for each group, the --light options that leave it alone, as bright as it was
    std::vector<double> factors;                   // of each group

    std::string key() const;  // of the pictures of groups
};

// Errors: kUsage, of what the recipe says about lights.
Result<LightMix> light_mix_of(const Recipe& recipe, const std::vector<std::string>& groups);

// Adds the pictures up. Its last digits can differ from those of a picture that is developed of all lights.
Status add_up(const std::vector<LinearPicture>& groups, const std::vector<double>& factors, develop::PictureSink& sink);

}  // namespace latent::darkroom
