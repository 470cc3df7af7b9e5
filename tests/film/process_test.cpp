#include "color/film/process.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "color/camera.h"
#include "color/difference.h"
#include "color/film/exposure.h"
#include "color/film/mono.h"
#include "color/power_of_ten.h"
#include "tests/color/simd_targets.h"
#include "tests/film/reference.h"

namespace latent::film {
namespace {

Triple triple(const nlohmann::json& json) { return {json[0], json[1], json[2]}; }

// Exposures as the reference adds them up, over 380..780 nm, of a reflectance under a light, on the scale of the exposure index.
Triple exposures(const Stock& film, const Curve& light, const Curve& reflectance) {
    Curve seen;
    for (std::size_t i = 0; i < kNm; ++i) seen[i] = light[i] * reflectance[i];
    Triple out;
    for (std::size_t c = 0; c < 3; ++c) out[c] = dot(seen, film.sensitivities()[c]) / 0.18 * 10 / film.material().exposure_index;
    return out;
}

Curve level(double value) {
    Curve out;
    out.fill(value);
    return out;
}

std::vector<Curve> chart() {
    std::vector<Curve> out;
    for (const color::Spectrum& patch : color::color_checker()) {
        Curve& curve = out.emplace_back();
        for (std::size_t i = 0; i < kNm; ++i) curve[i] = patch(kFirstNm + static_cast<double>(i));
    }
    return out;
}

double difference(const Triple& a, const Triple& b, const Triple& white) {
    const auto lab_of = [&](const Triple& c) { return color::lab_from_xyz({c[0], c[1], c[2]}, {white[0], white[1], white[2]}); };
    return color::ciede2000(lab_of(a), lab_of(b));
}

// A process of the reference, and its exposures.
struct Prepared {
    ReferencePair pair;
    Stock film;
    Curve taking;
    Triple grey;
    Process process;

    Prepared(const std::string& key, const nlohmann::json& expected)
        : pair(key),
          film(*Stock::make(*find_material(pair.film, true))),
          taking(light(expected["taking_light"].get<std::string>())),
          grey(exposures(film, taking, level(0.18))),
          process(*Process::make({.film = film.material(),
                                  .grey = {color::log10_of(grey[0]), color::log10_of(grey[1]), color::log10_of(grey[2])},
                                  .paper = pair.paper.empty() ? "light-table" : pair.paper,
                                  .couplers = !pair.plain,
                                  .trim = !pair.plain || pair.paper.empty()})) {}
};

// Numbers of the reference have five digits.
TEST(Process, AgreesWithTheReference) {
    for (const auto& [key, expected] : reference().items()) {
        SCOPED_TRACE(key);
        const Prepared p(key, expected);
        const auto& at_grey = expected["grey"];
        const auto near = [](const Triple& a, const Triple& b, double tolerance) {
            for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance);
        };
        if (!p.pair.paper.empty()) {
            near(p.process.film_amounts(p.grey), triple(at_grey["negative_amounts"]), 0.0002);
            near(p.film.integral_density(p.process.film_amounts(p.grey)), triple(at_grey["negative_status_m"]), 0.0002);
            const Stock paper = *Stock::make(*find_material(p.pair.paper, false));
            const Triple print = p.process.printer()->exposures(paper, p.film.density(p.process.film_amounts(p.grey)));
            near(paper.integral_density(paper.amounts(print)), triple(at_grey["print_status_a"]), 0.002);
            near(p.process.printer()->pack().ymc, triple(expected["print"]["pack_density_ymc"]), 0.0005);
            near(p.process.printer()->trim(), triple(expected["print"]["trim_rgb"]), 0.0005);
            EXPECT_NEAR(p.process.printer()->pack().log_time, expected["print"]["log10_time"], 0.0005);
        } else {
            near(p.process.shift(), triple(expected["neutral_shift"]), 0.0002);
            const Triple h{color::log10_of(p.grey[0]), color::log10_of(p.grey[1]), color::log10_of(p.grey[2])};
            near(p.film.integral_density(p.film.amounts(h)), triple(at_grey["status_a"]), 0.0002);
        }
        const Triple base = triple(expected["base_XYZ"]), white{base[0] / base[1], 1, base[2] / base[1]};
        const std::vector<Curve> patches = chart();
        for (std::size_t i = 0; i < patches.size(); ++i) {
            const Triple xyz = p.process.seen_by(exposures(p.film, p.taking, patches[i]));
            EXPECT_LT(difference(xyz, triple(expected["patches_XYZ"][i]), white), 0.02) << i;
        }
        for (std::size_t i = 0; i < 21; ++i) {
            const double stops = expected["grey_scale"]["stops"][i];
            const Triple xyz = p.process.seen_by(exposures(p.film, p.taking, level(0.18 * std::exp2(stops))));
            EXPECT_LT(difference(xyz, triple(expected["grey_scale"]["XYZ"][i]), white), 0.02) << stops;
        }
    }
}

std::array<std::vector<float>, 3> random_exposures(std::size_t count, double grey, double stops) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> spread(-stops, stops);
    std::array<std::vector<float>, 3> out;
    for (std::size_t i = 0; i < count; ++i) {
        const double level = spread(random);
        for (auto& plane : out) plane.push_back(static_cast<float>(grey * std::exp2(level + spread(random) / 4)));
    }
    return out;
}

std::array<std::vector<float>, 3> rows(const Process& process, const std::array<std::vector<float>, 3>& in, float scale = 1) {
    std::array<std::vector<float>, 3> out{std::vector<float>(in[0].size()), std::vector<float>(in[0].size()),
                                          std::vector<float>(in[0].size())};
    process.row(scale, {in[0], in[1], in[2]}, {out[0], out[1], out[2]});
    return out;
}

std::vector<ProcessSettings> all_kinds() {
    std::vector<ProcessSettings> all;
    for (const auto& [film, paper] : {std::pair{"portra-400", "endura"},
                                      {"ektar-100", "supra-endura"},
                                      {"vision3-500t", "2383"},
                                      {"pro-400h", "crystal-archive-super-c"},
                                      {"velvia-50", "light-table"},
                                      {"kodachrome-64", "projection"},
                                      {"provia-100f", "radiance"},
                                      {"gold-200", "scan"},
                                      {"tri-x-400", "polymax"},
                                      {"tri-x-400", "scan"},
                                      {"double-x", "2302"}}) {
        const Material material = *find_material(film, true);
        const double grey = color::log10_of(10 / material.exposure_index);
        all.push_back({.film = material, .grey = {grey, grey, grey}, .paper = paper});
    }
    return all;
}

std::vector<ProcessSettings> with_negatives_on_a_light_table() {
    std::vector<ProcessSettings> all = all_kinds();
    for (const char* film : {"portra-400", "tri-x-400"}) {
        const double grey = color::log10_of(10 / 400.0);
        all.push_back({.film = *find_material(film, true), .grey = {grey, grey, grey}, .paper = "light-table"});
    }
    return all;
}

// The error of the tables in steps of 8 bits, behind a curve of gamma 2.4: as docs/color.md says.
TEST(Process, RowsByTablesAreNearTheExactPrint) {
    for (const ProcessSettings& settings : with_negatives_on_a_light_table()) {
        SCOPED_TRACE(settings.film.name + " on " + settings.paper);
        const Process process = *Process::make(settings);
        const auto in = random_exposures(500, 10 / settings.film.exposure_index, 4);
        const auto out = rows(process, in);
        double most = 0, sum = 0;
        for (std::size_t i = 0; i < in[0].size(); ++i) {
            const Triple exact = process({in[0][i], in[1][i], in[2][i]});
            for (std::size_t c = 0; c < 3; ++c) {
                const double code = 255 * std::abs(std::pow(static_cast<double>(out[c][i]), 1 / 2.4) - std::pow(exact[c], 1 / 2.4));
                most = std::max(most, code);
                sum += code / static_cast<double>(3 * in[0].size());
            }
        }
        EXPECT_LT(most, 0.21);
        EXPECT_LT(sum, 0.03);
    }
}

TEST(Process, RowsAreTheSameWithEveryInstructionSet) {
    for (const ProcessSettings& settings : with_negatives_on_a_light_table()) {
        SCOPED_TRACE(settings.film.name + " on " + settings.paper);
        const Process process = *Process::make(settings);
        auto in = random_exposures(101, 10 / settings.film.exposure_index, 8);
        in[0][3] = 0, in[1][4] = -1, in[2][5] = std::numeric_limits<float>::quiet_NaN(),
        in[0][6] = std::numeric_limits<float>::infinity();
        std::vector<std::array<std::vector<float>, 3>> results;
        color::with_every_simd_target([&] { results.push_back(rows(process, in)); });
        for (const auto& result : results) EXPECT_EQ(result, results[0]);
        for (const auto& plane : results[0]) {
            for (const float v : plane) EXPECT_TRUE(std::isfinite(v) && v >= 0);
        }
    }
}

TEST(Process, AStopMoreIsTheSameAsTwiceTheExposure) {
    const Process process = *Process::make(all_kinds()[0]);
    const auto in = random_exposures(100, 10.0 / 400, 3);
    auto twice = in;
    for (auto& plane : twice) {
        for (float& v : plane) v *= 2;
    }
    EXPECT_EQ(rows(process, in, 2), rows(process, twice));
}

// Point by point, what a data sheet's own inconsistency leaves: docs/film.md.
TEST(Process, AGreyCardIsNeutralAndGreysNearlySo) {
    for (const ProcessSettings& settings : all_kinds()) {
        if (!settings.film.colour || settings.paper == "scan") continue;
        SCOPED_TRACE(settings.film.name + " on " + settings.paper);
        const Process process = *Process::make(settings);
        const color::Xyz w = color::xyz_from_chromaticity(process.white());
        const Triple white{w.x, w.y, w.z};
        for (double stops = -3; stops <= 2; stops += 0.5) {
            const double h = 10 / settings.film.exposure_index * std::exp2(stops);
            const Triple lab_of = lab(process({h, h, h}), white);
            const double chroma = std::hypot(lab_of[1], lab_of[2]);
            EXPECT_LT(chroma, stops == 0 ? 1 : settings.film.positive() ? 7 : 5) << stops;
        }
    }
}

TEST(Process, MoreLightInTheCameraMakesPrintsAndSlidesBrighterAndMoreInTheEnlargerMakesPrintsDarker) {
    for (ProcessSettings settings : all_kinds()) {
        SCOPED_TRACE(settings.film.name + " on " + settings.paper);
        const double grey = 10 / settings.film.exposure_index;
        const Process process = *Process::make(settings);
        double last = -1;
        for (double stops = -2; stops <= 2; stops += 0.5) {
            const double y = process({grey * std::exp2(stops), grey * std::exp2(stops), grey * std::exp2(stops)})[1];
            EXPECT_GT(y, last);
            last = y;
        }
        if (settings.paper == "scan" || settings.paper == "light-table" || settings.paper == "projection") continue;
        settings.print_stops = 0.5;
        const double longer = (*Process::make(settings))({grey, grey, grey})[1], usual = process({grey, grey, grey})[1];
        if (settings.film.positive())
            EXPECT_GT(longer, usual);
        else
            EXPECT_LT(longer, usual);
    }
}

TEST(Process, CouplersMakeColoursPurerAndLeaveGreysAlone) {
    for (const char* name : {"portra-400", "velvia-50"}) {
        const Stock film = *Stock::make(*find_material(name, true));
        const double h = color::log10_of(10 / film.material().exposure_index);
        EXPECT_EQ(film.coupled({h, h, h}, film.usual_coupling()), (Triple{h, h, h}));
        const Triple red{h + 0.5, h - 0.3, h - 0.3};
        const Triple plain = film.amounts(red), coupled = film.amounts(film.coupled(red, film.usual_coupling()));
        EXPECT_GT(std::abs(coupled[0] - coupled[1]), std::abs(plain[0] - plain[1]));
    }
}

TEST(Process, FiltersSetByHandMoveTheColourAwayFromNeutral) {
    ProcessSettings settings = all_kinds()[0];
    const Process automatic = *Process::make(settings);
    settings.pack = automatic.printer()->pack().ymc;
    const Process same = *Process::make(settings);
    const Triple grey{0.025, 0.025, 0.025};
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(automatic(grey)[c], same(grey)[c], 1e-6);
    (*settings.pack)[0] += 0.2;  // yellow: less blue light, so less yellow dye
    const Triple bluer = (*Process::make(settings))(grey);
    EXPECT_GT(bluer[2] / bluer[1], 1.05 * automatic(grey)[2] / automatic(grey)[1]);
}

// Log exposures [1/100] from 0.04 above the least density to 0.9 of the way to the largest [ISO6846]: as computed from the data
// sheet when its curves were digitised.
TEST(Process, PapersHaveTheExposureRangesOfTheirContrastFilters) {
    const Material paper = *find_material("polymax", false);
    for (const auto& [filter, range] :
         {std::pair{"00", 177}, {"0", 136}, {"1", 121}, {"2", 112}, {"3", 97}, {"4", 81}, {"5", 55}, {"", 101}}) {
        const MonoCurve curve = *mono_paper(paper, filter);
        const double least = std::ranges::min(curve.density), most = std::ranges::max(curve.density);
        const auto at = [&](double density) { return inverted(curve.log_exposure, curve.density, density); };
        EXPECT_NEAR(100 * (at(least + 0.9 * (most - least)) - at(least + 0.04)), range, 3) << filter;
    }
}

TEST(Process, AGreyCardPrintsAt18PercentWithEveryContrastFilter) {
    for (const char* filter : {"", "00", "0", "1", "2", "3", "4", "5"}) {
        ProcessSettings settings = all_kinds()[8];
        settings.contrast_filter = filter;
        EXPECT_NEAR((*Process::make(settings)).seen_by({0.025, 0, 0})[1], 0.18, 1e-6) << filter;
    }
}

TEST(Process, AGreyCardPrintsAt10PercentOnPrintFilmInColourOrNot) {
    for (const ProcessSettings& settings : all_kinds()) {
        if (settings.paper != "2383" && settings.paper != "2302") continue;
        const double h = 10 / settings.film.exposure_index;
        EXPECT_NEAR((*Process::make(settings)).seen_by({h, h, h})[1], 0.10, 1e-6) << settings.paper;
    }
}

TEST(Process, ALampIsWhiteOnPrintsOfEveryNegative) {
    for (const ProcessSettings& settings : all_kinds()) {
        if (settings.film.positive() || settings.paper == "scan") continue;
        SCOPED_TRACE(settings.film.name);
        const Process process = *Process::make(settings);
        double before = 0;
        for (int stops = -4; stops <= 12; ++stops) {  // the plots of some data sheets end three stops above the grey card
            const double h = 10 / settings.film.exposure_index * std::exp2(stops), y = process({h, h, h})[1];
            EXPECT_GE(y, before) << stops;
            before = y;
        }
        EXPECT_GT(before, 0.8);
    }
}

TEST(Process, PushingRaisesTheContrast) {
    for (ProcessSettings settings : {all_kinds()[0], all_kinds()[8]}) {
        settings.paper = "scan";
        const auto slope = [&](double push) {
            settings.push = push;
            const Process process = *Process::make(settings);
            return process.film_amounts({0.1, 0.1, 0.1})[1] - process.film_amounts({0.025, 0.025, 0.025})[1];
        };
        EXPECT_NEAR(slope(1) / slope(0), 1.15, 0.06);
        EXPECT_LT(slope(-1), slope(0));
    }
}

// On a light table, a negative is as dark as its densities say, which are those of the sheet.
TEST(Process, ANegativeOnALightTableIsDarkWhereTheSceneIsLightAndItsMaskIsOrange) {
    const Process colour =
        *Process::make({.film = *find_material("portra-400", true), .grey = {-1.6, -1.6, -1.6}, .paper = "light-table"});
    const Triple clear = colour({1e-9, 1e-9, 1e-9}), light = colour({1, 1, 1});
    EXPECT_GT(clear[1], 5 * light[1]);
    const color::Chromaticity mask = color::chromaticity({clear[0], clear[1], clear[2]});
    EXPECT_GT(mask.x, colour.white().x + 0.05);
    EXPECT_GT(mask.x, mask.y);
    const Process grey =
        *Process::make({.film = *find_material("tri-x-400", true), .grey = {-1.6, -1.6, -1.6}, .paper = "light-table"});
    for (const double h : {0.001, 0.03, 1.0}) EXPECT_NEAR(grey({h, h, h})[1], std::pow(10, -grey.film_amounts({h, h, h})[0]), 1e-9);
}

TEST(Process, WhatDoesNotGoTogetherIsRefusedWithWhatDoes) {
    for (const auto& [film, paper, message] : {std::tuple{"portra-400", "projection", "endura"},
                                               {"portra-400", "polymax", "endura"},
                                               {"portra-400", "radiance", "endura"},
                                               {"velvia-50", "endura", "light-table"},
                                               {"velvia-50", "scan", "light-table"},
                                               {"tri-x-400", "endura", "polymax"},
                                               {"portra-400", "endurra", "did you mean endura"}}) {
        const Result<Process> process = Process::make({.film = *find_material(film, true), .grey = {-1, -1, -1}, .paper = paper});
        ASSERT_FALSE(process) << film << " " << paper;
        EXPECT_EQ(process.error().code, ErrorCode::kUsage);
        EXPECT_NE(process.error().message.find(message), std::string::npos) << process.error().message;
    }
}

}  // namespace
}  // namespace latent::film
