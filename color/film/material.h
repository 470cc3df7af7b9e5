// color/film/material.h: films and print materials that have a name, and the digitised curves of each. docs/film.md.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace latent::film {

enum class Kind { kNegative, kReversal, kPrintPaper, kPrintFilm, kReversalPrint };

// A row of materials.csv.
struct Material {
    std::string name;   // "portra-400"; case, '-' and '_' make no difference to those who look it up
    std::string title;  // "Kodak Portra 400"
    std::string file;   // tables are in FILE.curves.csv and so on
    Kind kind = Kind::kNegative;
    bool colour = true;         // three layers; else one
    double exposure_index = 0;  // what the box of a camera film says; 0: no camera film
    std::string balance;        // light of its neutral exposures: "D55", "3200K"
    char status = 'A';          // kind of densities: 'A', 'M' [ISO5-3], 'v' visual (black and white)
    std::string process;
    double speed_from_curves = 0;    // ISO speed that its curves have; 0: unknown
    double rms = 0;                  // 1000 x rms of density through an aperture of 48 um, at density 1; 0: unknown
    bool rms_measured = false;       // by the maker
    std::string mtf, year, note;     // `mtf`: "yes", "copy of FILE", or ""
    bool dyes_have_base = false;     // the plot of its dyes includes its base
    std::filesystem::path folder{};  // where its tables are; empty: those that are compiled in

    bool in_camera() const { return kind == Kind::kNegative || kind == Kind::kReversal; }
    bool positive() const { return kind == Kind::kReversal || kind == Kind::kReversalPrint; }
};

// All that are compiled in.
const std::vector<Material>& materials();

// By name, title or file; or FOLDER/NAME, where FOLDER holds a materials.csv and tables as color/data/film does. Errors: kUsage,
// with names that are near; those of reading.
Result<Material> find_material(std::string_view name, bool in_camera);

// For people: name, title, kind, speed, how complete the data are; and where the numbers come from.
std::string list_films();
std::string list_papers();

// A table of numbers with named columns, such as "curves" of a material. Finite, and without gaps; the first column strictly
// increases.
struct Columns {
    std::vector<std::string> names;
    std::vector<std::vector<double>> values;  // by column

    bool has(std::string_view name) const;
    const std::vector<double>& operator[](std::string_view name) const;  // that exists
};
// `what`: "sensitivity", "curves", "dyes", "mtf" or "grain". Nothing if the material has no such table. Errors: kCorrupt, kIo.
Result<std::optional<Columns>> find_table(const Material& material, std::string_view what);
// The same, of a table that the material cannot do without, with these columns behind the first one, which is wavelength_nm; of
// "curves", log10_exposure: 0.05 apart, and densities rise with it (of positives: fall). Errors: kNotFound, kCorrupt.
Result<Columns> need_table(const Material& material, std::string_view what, const std::vector<std::string>& columns);
// FOLDER/FILE.curves.csv, for messages.
std::string table_file(const Material& material, std::string_view what);
// A table of color/data/film that belongs to no material: "status_m".
Columns common_table(std::string_view name);

}  // namespace latent::film
