// tools/convert/looks.h: films, papers and formats that photographers know together. docs/film.md, "Looks".
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "tools/convert/darkroom.h"

namespace latent::convert {

struct NamedLook {
    std::string_view name, film, what;  // `film`: to develop with
};
std::vector<NamedLook> looks();

// For people: each look, what it is, and the film to develop with.
std::string list_looks();

// Fills in what was not asked for otherwise, and is known of the film; `notes` say what is not. Errors: kUsage, with all names; if
// the picture is on another film, or none.
Status add_look(std::string_view name, const std::string& input, std::string_view film, DarkroomOptions& darkroom,
                std::vector<std::string>& notes);

}  // namespace latent::convert
