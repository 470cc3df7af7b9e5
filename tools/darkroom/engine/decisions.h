// tools/darkroom/engine/decisions.h: a recipe as the options of develop and convert.
#pragma once

#include <string>

#include "base/recipe.h"
#include "base/result.h"
#include "tools/convert/options.h"
#include "tools/develop/picture/picture.h"

namespace latent::darkroom {

struct Decisions {
    develop::PictureOptions picture;
    convert::ConvertOptions print;
    Recipe recipe;  // that they are from

    // What decides about light before it is printed, apart from its size and crop: equal texts, equal light.
    std::string of_light() const;
    // Whether a pixel depends on others that may be anywhere in the picture.
    bool spreads_light() const;
};

// Errors: kUsage, as the tools say it.
Result<Decisions> decide(const Recipe& recipe);

// Errors: kUsage, for what only a print can have, not a view.
Status check_view(const Decisions& decisions);

}  // namespace latent::darkroom
