// render/program/arguments.h: the arguments of latent-render that are more than one number.
#pragma once

#include <string>

#include "base/result.h"
#include "render/program/job.h"

namespace latent::render {

// As given on the command line; empty: not given.
struct RangeArguments {
    std::string samples;     // "65536:131072"
    std::string shard;       // "0/4"
    std::string resolution;  // "1920x1080"
    std::string depth;       // "12" or "unlimited"
};

// Errors: kUsage, naming the option and showing what it should look like.
Status parse_ranges(const RangeArguments& arguments, RenderSettings& settings);

}  // namespace latent::render
