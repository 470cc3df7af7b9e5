#include "tools/convert/looks.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "color/film/blur.h"
#include "color/film/grain.h"
#include "color/film/material.h"

namespace latent::convert {
namespace {

struct Look {
    const char* name;
    const char* film;  // and its paper; "": any
    const char* paper;
    const char* format;
    Halation halation;
    const char* contrast_filter;
    const char* text;
};

using enum Halation;

constexpr Look kLooks[] = {
    {"portrait", "portra-400", "endura", "6x7", kBacked, "", "soft skin tones of the studio"},
    {"wedding", "pro-400h", "crystal-archive-super-c", "6x4.5", kBacked, "", "pale and cool, with gentle greens"},
    {"family", "gold-200", "crystal-archive-dpii", "35mm", kBacked, "", "warm prints of the album"},
    {"drugstore", "superia-400", "crystal-archive-pdii", "35mm", kBacked, "", "prints of the one-hour laboratory"},
    {"vivid", "ektar-100", "supra-endura", "35mm", kBacked, "", "saturated and fine-grained"},
    {"available-light", "portra-800", "endura-premier", "35mm", kBacked, "", "indoors without a flash"},
    {"cinema", "vision3-250d", "2383", "super35", kBacked, "", "a feature film by day"},
    {"night-film", "vision3-500t", "2383", "35mm", kBare, "", "tungsten film without its black back: red halos around lamps"},
    {"landscape", "velvia-50", "light-table", "4x5in", kBacked, "", "a large slide of deep colours"},
    {"magazine", "kodachrome-64", "projection", "35mm", kBacked, "", "a slide of the seventies, projected"},
    {"reportage", "tri-x-400", "polymax", "35mm", kBacked, "3", "black and white with visible grain"},
    {"noir", "double-x", "2302", "super35", kBacked, "", "black-and-white cinema"},
};
constexpr Look kFull{"full", "", "", "35mm", kBacked, "", ""};

}  // namespace

std::vector<NamedLook> looks() {
    std::vector<NamedLook> named;
    for (const Look& look : kLooks) named.push_back({look.name, look.film, look.text});
    return named;
}

std::string list_looks() {
    std::string text = "looks (--look), and the film to develop with; full: any film, on the paper that you name\n";
    for (const Look& look : kLooks)
        text += fmt::format("  {:<16} latent-develop --film {:<13} {}: {}, {}\n", look.name, look.film, look.text, look.paper,
                            look.format);
    return text;
}

Status add_look(std::string_view name, const std::string& input, std::string_view film, DarkroomOptions& darkroom,
                std::vector<std::string>& notes) {
    const auto* look =
        name == kFull.name ? &kFull : std::ranges::find_if(kLooks, [&](const Look& each) { return name == each.name; });
    if (look == std::end(kLooks)) {
        std::vector<std::string> names;
        for (const Look& each : kLooks) names.emplace_back(each.name);
        return usage_error(fmt::format("'{}' is not a look (try {}, full); --list-looks shows all", name, fmt::join(names, ", ")));
    }
    const std::string own = *look->film != 0 ? look->film : "portra-400";
    const Result<film::Material> exposed = film::find_material(film, true);
    if (film.empty() || (look != &kFull && (!exposed || exposed->name != own)))
        return usage_error(fmt::format("{}: {}, but the look '{}' is that of {}; develop with --film {}", input,
                                       film.empty() ? "holds no exposures of a film" : fmt::format("is on {}", film), name,
                                       look == &kFull ? "any film" : own, own));
    if (!exposed) return exposed.error().at("--film");
    if (darkroom.paper.empty()) {
        darkroom.paper = look->paper;
        if (darkroom.contrast_filter.empty()) darkroom.contrast_filter = look->contrast_filter;
    }
    if (!darkroom.frame_mm) darkroom.frame_mm = *parse_format(look->format);
    darkroom.halation = darkroom.halation.value_or(look->halation);
    const auto add = [&](std::optional<bool>& option, const auto& data, const char* what) {
        const bool known = data || data.error().code != ErrorCode::kUnsupported;  // other errors are met again, and told
        if (!option && !known && look == &kFull)
            notes.push_back(fmt::format("{}: its {} is not known, and is left out", exposed->title, what));
        option = option.value_or(known);
    };
    add(darkroom.grain, film::granularity(*exposed, 0), "granularity");
    add(darkroom.mtf, film::half_contrast(*exposed), "sharpness");
    return {};
}

}  // namespace latent::convert
