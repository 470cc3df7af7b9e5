// tools/inspect/arguments.h: options that are read as text and understood afterwards.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "base/result.h"
#include "tools/inspect/cat.h"
#include "tools/inspect/gen.h"

namespace latent::inspect {

struct TextArguments {
    std::string samples, format = "csv";  // cat
    std::vector<double> region;
    std::string records = "1M", kind = "xyz", aspect = "1:1", texture = "textured";  // gen
    std::uint64_t first = 0;

    // Errors: kUsage.
    Status apply(CatOptions& cat, GenOptions& gen) const;
};

void add_cat_options(CLI::App& cat, CatOptions& options, TextArguments& text);
void add_gen_options(CLI::App& gen, GenOptions& options, TextArguments& text);

}  // namespace latent::inspect
