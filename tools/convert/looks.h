// tools/convert/looks.h: films, papers and formats that photographers know together. docs/film.md, "Looks".
#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "tools/convert/darkroom.h"

namespace latent::convert {

// For people: each look, what it is, and the film to develop with.
std::string list_looks();

// Fills in what was not asked for otherwise. Errors: kUsage, with all names; if the picture is on another film.
Status add_look(std::string_view name, const std::string& input, std::string_view film, DarkroomOptions& darkroom);

}  // namespace latent::convert
