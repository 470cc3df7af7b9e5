#include "tools/convert/looks.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "color/film/material.h"

namespace latent::convert {
namespace {

struct Look {
    const char* name;
    const char* film;
    const char* paper;
    const char* format;
    Halation halation;
    bool mtf;  // where the film's is known
    const char* contrast_filter;
    const char* text;
};

using enum Halation;

constexpr Look kLooks[] = {
    {"portrait", "portra-400", "endura", "6x7", kBacked, true, "", "soft skin tones of the studio"},
    {"wedding", "pro-400h", "crystal-archive-super-c", "6x4.5", kBacked, true, "", "pale and cool, with gentle greens"},
    {"family", "gold-200", "crystal-archive-dpii", "35mm", kBacked, true, "", "warm prints of the album"},
    {"drugstore", "superia-400", "crystal-archive-pdii", "35mm", kBacked, true, "", "prints of the one-hour laboratory"},
    {"vivid", "ektar-100", "supra-endura", "35mm", kBacked, true, "", "saturated and fine-grained"},
    {"available-light", "portra-800", "endura-premier", "35mm", kBacked, true, "", "indoors without a flash"},
    {"cinema", "vision3-250d", "2383", "super35", kBacked, true, "", "a feature film by day"},
    {"night-film", "vision3-500t", "2383", "35mm", kBare, true, "", "tungsten film without its black back: red halos around lamps"},
    {"landscape", "velvia-50", "light-table", "4x5in", kBacked, true, "", "a large slide of deep colours"},
    {"magazine", "kodachrome-64", "projection", "35mm", kBacked, true, "", "a slide of the seventies, projected"},
    {"reportage", "tri-x-400", "polymax", "35mm", kBacked, false, "3", "black and white with visible grain"},
    {"noir", "double-x", "2302", "super35", kBacked, false, "", "black-and-white cinema"},
};

}  // namespace

std::string list_looks() {
    std::string text = "looks (--look), and the film to develop with:\n";
    for (const Look& look : kLooks)
        text += fmt::format("  {:<16} latent-develop --film {:<13} {}: {}, {}\n", look.name, look.film, look.text, look.paper,
                            look.format);
    return text;
}

Status add_look(std::string_view name, const std::string& input, std::string_view film, DarkroomOptions& darkroom) {
    const auto* look = std::ranges::find_if(kLooks, [&](const Look& each) { return name == each.name; });
    if (look == std::end(kLooks)) {
        std::vector<std::string> names;
        for (const Look& each : kLooks) names.emplace_back(each.name);
        return usage_error(fmt::format("'{}' is not a look (try {}); --list-looks shows all", name, fmt::join(names, ", ")));
    }
    const Result<film::Material> own = film::find_material(look->film, true), exposed = film::find_material(film, true);
    if (!own) return own.error();
    if (!exposed || exposed->name != own->name)
        return usage_error(fmt::format("{}: {}, but the look '{}' is that of {}; develop with --film {}", input,
                                       film.empty() ? "holds no exposures of a film" : fmt::format("is on {}", film), name,
                                       look->film, look->film));
    if (darkroom.paper.empty()) {
        darkroom.paper = look->paper;
        if (darkroom.contrast_filter.empty()) darkroom.contrast_filter = look->contrast_filter;
    }
    if (!darkroom.frame_mm) darkroom.frame_mm = *parse_format(look->format);
    darkroom.grain = darkroom.grain.value_or(true);
    darkroom.mtf = darkroom.mtf.value_or(look->mtf);
    darkroom.halation = darkroom.halation.value_or(look->halation);
    return {};
}

}  // namespace latent::convert
