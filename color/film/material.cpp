#include "color/film/material.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/near_names.h"
#include "base/parse.h"
#include "base/small_file.h"
#include "color/csv.h"
#include "color/tables.h"

namespace latent::film {
namespace {

constexpr std::uint64_t kMaxBytes = 16 << 20;

std::vector<std::string> split_at_commas(std::string_view line) {
    std::vector<std::string> fields;
    for (std::size_t begin = 0; begin <= line.size();) {
        const std::size_t end = std::min(line.find(',', begin), line.size());
        fields.emplace_back(line.substr(begin, end - begin));
        begin = end + 1;
    }
    return fields;
}

Status read_kind(const std::string& text, Material& material) {
    constexpr std::string_view kGrey = " (black and white)";
    std::string_view kind = text;
    material.colour = !kind.ends_with(kGrey);
    if (!material.colour) kind.remove_suffix(kGrey.size());
    for (const auto& [word, meaning] : {std::pair{"negative", Kind::kNegative},
                                        {"reversal", Kind::kReversal},
                                        {"print paper", Kind::kPrintPaper},
                                        {"print film", Kind::kPrintFilm},
                                        {"reversal print", Kind::kReversalPrint}}) {
        if (kind != word) continue;
        material.kind = meaning;
        return {};
    }
    return Error{ErrorCode::kCorrupt,
                 fmt::format("kind: '{}' is not negative, reversal, print paper, print film or reversal print", text)};
}

// A field may be empty, if `optional`.
Result<double> number_field(const std::string& name, const std::string& text) {
    if (text.empty()) return 0.0;
    const Result<double> number = parse_number(text);
    if (number && *number >= 0) return number;
    return Error{ErrorCode::kCorrupt, fmt::format("{}: '{}' is not a number", name, text)};
}

Result<Material> read_material(const std::vector<std::string>& names, const std::vector<std::string>& fields) {
    if (fields.size() != names.size())
        return Error{ErrorCode::kCorrupt, fmt::format("{} fields, but the first line names {}", fields.size(), names.size())};
    const auto field = [&](std::string_view name) {
        const auto found = std::ranges::find(names, name);
        return found == names.end() ? std::string() : fields[static_cast<std::size_t>(found - names.begin())];
    };
    Material material{.name = field("name"),
                      .title = field("title"),
                      .file = field("file"),
                      .balance = field("balance"),
                      .process = field("process"),
                      .mtf = field("mtf"),
                      .year = field("year"),
                      .note = field("note")};
    if (material.name.empty() || material.file.empty()) return Error{ErrorCode::kCorrupt, "needs a name and a file"};
    if (material.title.empty()) material.title = material.name;
    if (Status s = read_kind(field("kind"), material); !s) return s.error();
    for (const auto& [name, value] : {std::pair{"exposure_index", &material.exposure_index},
                                      {"speed_from_curves", &material.speed_from_curves},
                                      {"rms_granularity", &material.rms}}) {
        const Result<double> number = number_field(name, field(name));
        if (!number) return number.error();
        *value = *number;
    }
    const std::string densitometry = field("densitometry");
    material.status = densitometry == "status M" ? 'M' : densitometry == "status A" ? 'A' : 'v';
    material.rms_measured = field("rms_source") == "repository";
    material.dyes_have_base = field("dyes_include_base") == "yes";
    if (material.in_camera() && !(material.exposure_index > 0))
        return Error{ErrorCode::kCorrupt, "a film for cameras needs an exposure_index"};
    if (material.balance != "D55" && material.balance != "3200K" && material.balance != "3000K")
        return Error{ErrorCode::kCorrupt, fmt::format("balance: '{}' is not D55, 3200K or 3000K", material.balance)};
    if (material.colour ? material.status == 'v' : densitometry != "visual")
        return Error{ErrorCode::kCorrupt, fmt::format("densitometry: '{}' is not {}", densitometry,
                                                      material.colour ? "status M or status A" : "visual")};
    return material;
}

Result<std::vector<Material>> read_materials(std::string_view text, const std::filesystem::path& folder) {
    std::vector<Material> all;
    std::vector<std::string> names;
    for (int line = 1; !text.empty(); ++line) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view content = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        if (content.ends_with('\r')) content.remove_suffix(1);
        if (content.empty() || content.starts_with('#')) continue;
        if (names.empty()) {
            names = split_at_commas(content);
            continue;
        }
        Result<Material> material = read_material(names, split_at_commas(content));
        if (!material) return material.error().at(fmt::format("line {}", line));
        material->folder = folder;
        all.push_back(*std::move(material));
    }
    return all;
}

Error not_here(std::string_view name, bool in_camera, const std::vector<std::string>& names) {
    const std::string near = near_names(name, names);
    const std::string_view kind = in_camera ? "film" : "print material";
    return usage_error(fmt::format("unknown {} '{}'; {}{} shows all", kind, name,
                                   near.empty() ? "" : fmt::format("did you mean {}? ", near),
                                   in_camera ? "--list-films" : "--list-papers"));
}

// What is missing of its data, for people.
std::string gaps(const Material& material) {
    std::string text;
    const auto add = [&](const char* what) { text += (text.empty() ? "" : ", ") + std::string(what); };
    const Result<std::optional<Columns>> dyes = find_table(material, "dyes");
    if (material.colour && dyes && *dyes && !(*dyes)->has("cyan")) add("dyes separated by a template");
    if (material.in_camera()) {
        const auto grain = find_table(material, "grain");
        if (material.rms == 0 && !(grain && *grain)) add("no granularity");
        if (material.rms > 0 && !material.rms_measured && !(grain && *grain)) add("granularity guessed");
        if (material.mtf.empty()) add("no MTF");
        if (material.mtf.starts_with("copy")) add("MTF of another film");
    }
    return text.empty() ? "complete" : text;
}

std::string_view kind_of(const Material& material) {
    switch (material.kind) {
        case Kind::kNegative:
            return material.colour ? "colour negative" : "black-and-white negative";
        case Kind::kReversal:
            return "slide";
        case Kind::kPrintPaper:
            return material.colour ? "colour paper" : "black-and-white paper";
        case Kind::kPrintFilm:
            return material.colour ? "print film for projection" : "black-and-white print film";
        case Kind::kReversalPrint:
            return "paper for slides";
    }
    return "";
}

constexpr const char* kSource =
    "source: the makers' data sheets, digitised in JanLohse/spectral_film_lut (MIT); color/data/film/materials.csv\n";

Columns columns_of(const color::Table& t) {
    Columns out;
    for (const std::string_view name : t.columns) {
        out.names.emplace_back(name);
        out.values.push_back(t.column(name));
    }
    return out;
}

Result<Columns> columns_from_text(std::string_view text) {
    Columns out;
    std::vector<color::CsvRow> rows = color::csv_rows(text);
    if (rows.empty() || color::csv_number(rows[0].fields[0]))
        return Error{ErrorCode::kCorrupt, "needs a first line with the names of its columns"};
    for (const std::string_view name : rows[0].fields) out.names.emplace_back(name);
    out.values.resize(out.names.size());
    rows.erase(rows.begin());
    if (rows.size() < 2) return Error{ErrorCode::kCorrupt, "needs at least two lines of numbers"};
    for (const color::CsvRow& row : rows) {
        if (row.fields.size() != out.names.size()) {
            return color::csv_error(row.line, fmt::format("{} values for {} columns; gaps are not filled in: write every value",
                                                          row.fields.size(), out.names.size()));
        }
        for (std::size_t i = 0; i < row.fields.size(); ++i) {
            const std::optional<double> number = color::csv_number(row.fields[i]);
            if (!number) return color::csv_error(row.line, fmt::format("\"{}\" is not a finite number", row.fields[i]));
            if (i == 0 && !out.values[0].empty() && *number <= out.values[0].back())
                return color::csv_error(row.line, fmt::format("{} must increase, but {} follows {}; sort the lines", out.names[0],
                                                              *number, out.values[0].back()));
            out.values[i].push_back(*number);
        }
    }
    return out;
}

Status check_curves(const Material& material, const Columns& curves) {
    const auto wrong = [](std::string what) { return Error{ErrorCode::kCorrupt, std::move(what)}; };
    const std::vector<double>& h = curves.values[0];
    for (std::size_t i = 1; i < h.size(); ++i) {
        if (std::abs(h[i] - h[i - 1] - 0.05) < 1e-9) continue;
        return wrong(fmt::format("log exposures must be 0.05 apart without gaps, but {} follows {}", h[i], h[i - 1]));
    }
    if (h.size() < 20) return wrong("needs at least 20 rows");
    constexpr double kLeast = -0.1, kMost = 10, kLeastRange = 0.5, kMostReturn = 0.02;  // bounds of a density; noise may be below 0
    for (std::size_t c = 1; c < curves.names.size(); ++c) {
        const std::vector<double>& density = curves.values[c];
        double extreme = density.front();
        for (std::size_t i = 0; i < density.size(); ++i) {
            const double d = density[i];
            if (!(d >= kLeast && d <= kMost))
                return wrong(fmt::format("{}: {} is not a density from 0 to {}", curves.names[c], d, kMost));
            extreme = material.positive() ? std::min(extreme, d) : std::max(extreme, d);
            if (std::abs(d - extreme) > kMostReturn) {
                return wrong(fmt::format("{}: must {} where exposure rises, but is {} at {} after {}", curves.names[c],
                                         material.positive() ? "fall" : "rise", d, h[i], extreme));
            }
        }
        const double rise = density.back() - density.front();
        if ((material.positive() ? -rise : rise) < kLeastRange) {
            return wrong(
                fmt::format("{}: must {} by {} or more where exposure rises, but is {} in the first row and {} in the last",
                            curves.names[c], material.positive() ? "fall" : "rise", kLeastRange, density.front(), density.back()));
        }
    }
    return {};
}

}  // namespace

const std::vector<Material>& materials() {
    static const std::vector<Material> all = [] {
        Result<std::vector<Material>> read = read_materials(color::film_materials(), {});
        assert(read);
        return *std::move(read);
    }();
    return all;
}

Result<Material> find_material(std::string_view name, bool in_camera) {
    const std::size_t slash = name.rfind('/');
    std::vector<Material> own;
    if (slash != std::string_view::npos) {
        const std::filesystem::path folder(name.substr(0, slash));
        name.remove_prefix(slash + 1);
        const std::string index = (folder / "materials.csv").string();
        const Result<std::string> text = read_small_file(index, kMaxBytes, "a list of materials");
        if (!text) return text.error();
        Result<std::vector<Material>> read = read_materials(*text, folder);
        if (!read) return read.error().at(index);
        own = *std::move(read);
    }
    std::vector<std::string> names;
    for (const Material& material : slash == std::string_view::npos ? materials() : own) {
        if (material.in_camera() != in_camera) continue;
        for (const std::string* one : {&material.name, &material.file, &material.title}) {
            if (folded_name(*one) == folded_name(name)) return material;
        }
        names.push_back(material.name);
    }
    return not_here(name, in_camera, names);
}

std::string list_films() {
    std::string text = "films (--film); EI is the exposure index, speed that of the curves:\n";
    for (const Material& m : materials()) {
        if (!m.in_camera()) continue;
        text += fmt::format("  {:17} {}\n  {:17} {}, {}, EI {:g}", m.name, m.title, "", kind_of(m),
                            m.balance == "D55" ? "daylight" : "tungsten light", m.exposure_index);
        if (m.speed_from_curves > 0) text += fmt::format(", speed {:g}", m.speed_from_curves);
        text += fmt::format("; {}; data: {}\n", m.process, gaps(m));
        if (!m.note.empty()) text += fmt::format("  {:17} {}\n", "", m.note);
    }
    return text + kSource;
}

std::string list_papers() {
    std::string text = "print materials (--paper):\n";
    for (const Material& m : materials()) {
        if (m.in_camera()) continue;
        text += fmt::format("  {:24} {}\n  {:24} {}; {}; data: {}\n", m.name, m.title, "", kind_of(m), m.process, gaps(m));
        if (!m.note.empty()) text += fmt::format("  {:24} {}\n", "", m.note);
    }
    return text + kSource;
}

bool Columns::has(std::string_view name) const { return std::ranges::find(names, name) != names.end(); }

const std::vector<double>& Columns::operator[](std::string_view name) const {
    const auto found = std::ranges::find(names, name);
    assert(found != names.end());
    return values[static_cast<std::size_t>(found - names.begin())];
}

Columns common_table(std::string_view name) { return columns_of(color::table(fmt::format("film/{}", name))); }

Result<std::optional<Columns>> find_table(const Material& material, std::string_view what) {
    if (material.folder.empty()) {
        const std::string name = fmt::format("film/{}.{}", material.file, what);
        const auto found = std::ranges::find(color::tables(), name, &color::Table::name);
        if (found == color::tables().end()) return std::optional<Columns>{};
        return std::optional(columns_of(*found));
    }
    const std::string path = table_file(material, what);
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return std::optional<Columns>{};
    const Result<std::string> text = read_small_file(path, kMaxBytes, "a table");
    if (!text) return text.error();
    Result<Columns> read = columns_from_text(*text);
    if (!read) return read.error().at(path);
    return std::optional(*std::move(read));
}

Result<Columns> need_table(const Material& material, std::string_view what, const std::vector<std::string>& columns) {
    Result<std::optional<Columns>> found = find_table(material, what);
    if (!found) return found.error();
    const std::string file = table_file(material, what);
    if (!*found) return Error{ErrorCode::kNotFound, fmt::format("{}: no such file, but {} needs it", file, material.title)};
    const std::string_view first = what == "curves" ? "log10_exposure" : "wavelength_nm";
    if ((*found)->names[0] != first)
        return Error{ErrorCode::kCorrupt, fmt::format("{}: its first column must be {}, not {}", file, first, (*found)->names[0])};
    for (const std::string& column : columns) {
        if (!(*found)->has(column))
            return Error{ErrorCode::kCorrupt, fmt::format("{}: has no column {}, which {} needs", file, column, material.title)};
    }
    if (what == "curves") {
        if (Status s = check_curves(material, **found); !s) return s.error().at(file);
    }
    return *std::move(*found);
}

std::string table_file(const Material& material, std::string_view what) {
    return (material.folder / fmt::format("{}.{}.csv", material.file, what)).string();
}

}  // namespace latent::film
