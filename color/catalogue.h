// color/catalogue.h: observers and lens filters that have a name. Numbers: color/data/README.md.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "color/spectrum.h"

namespace latent::color {

struct CatalogueEntry {
    std::string name;         // "canon_eos_5d"; case, '-' and '_' make no difference to those who look it up
    std::string_view what;    // it is
    std::string_view source;  // where its numbers come from
    std::string_view table;   // in color/tables.h
    std::string_view column;  // in a filter's table
};

const std::vector<CatalogueEntry>& observer_catalogue();     // the CIE's, cameras, films
const std::vector<CatalogueEntry>& lens_filter_catalogue();  // wratten-3 .. wratten-99, wratten-cc05m .. wratten-cc50m

// A title, and below it the entries with the sources of their numbers, for people to read.
std::string listing(std::string_view title, const std::vector<CatalogueEntry>& entries);

// Transmittance, 0..1; its end values go on beyond its table. Or "mired:131": an ideal conversion filter, which makes a blackbody
// of temperature T one of 1 / (1/T + 131e-6), in Wien's approximation. Errors: kNotFound, naming filters that are near.
Result<Spectrum> lens_filter(std::string_view name);

}  // namespace latent::color
