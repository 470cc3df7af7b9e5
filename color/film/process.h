// color/film/process.h: from exposures of a film to the colours of its print: developer, enlarger, paper, viewing light.
// Equations and errors: docs/color.md, "Film".
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "color/film/printer.h"
#include "color/film/process_row.h"
#include "color/film/process_tables.h"
#include "color/film/stock.h"
#include "color/tristimulus.h"

namespace latent::film {

struct ProcessSettings {
    Material film;
    double push = 0;                // stops that the film is developed longer
    Triple grey{};                  // log10 exposures [lux s] of the grey card that the print is made for
    std::string paper;              // "scan", "light-table", "projection", or of material.h
    bool couplers = true;           // layers hold each other back
    bool trim = true;               // the print's contrasts are matched, so that greys are neutral; slides: their grey card is
    std::optional<Triple> pack{};   // densities of the filters Y, M, C; else solved
    double print_stops = 0;         // more light in the enlarger
    std::string contrast_filter{};  // for paper with variable contrast: "00", "0" .. "5"; "": none
};

// Immutable; any thread.
class Process {
 public:
    // Errors: kUsage for materials that do not go together, with those that do; those of Stock::make.
    static Result<Process> make(const ProcessSettings& settings);

    // XYZ of CIE 1931 of one exposure [lux s], in double and without tables: the reference. The paper's white has Y = 1; a scan is
    // on the scale of the scene, a grey card at 0.18.
    Triple operator()(const Triple& exposure) const;
    // The same without the division by Y of the base: relative to the viewing light.
    Triple seen_by(const Triple& exposure) const;
    // Amounts of dye in the film (black and white: density, three times).
    Triple film_amounts(const Triple& exposure) const;

    // The same by tables, over rows: exposures times `scale` in, XYZ out, which may be the same rows; the same bits with every
    // instruction set. How near it is: docs/color.md, "Film".
    void row(float scale, const std::array<std::span<const float>, 3>& exposures, const std::array<std::span<float>, 3>& xyz,
             const GrainRow* grain = nullptr) const;

    color::Chromaticity white() const { return white_; }  // what the print's neutrals look like
    const std::optional<Printer>& printer() const { return printer_; }
    const Triple& shift() const { return shift_; }
    // For the report: "portra-400 on endura, filters 54Y 46M 0C".
    const std::string& description() const { return description_; }

 private:
    Process() = default;
    Status make_colour(const ProcessSettings& settings);
    Status make_black_and_white(const ProcessSettings& settings);
    void fill_tables();
    Triple mono_xyz(double y) const;

    std::string description_;
    bool scan_ = false;
    double push_ = 0;
    color::Chromaticity white_;
    double base_luminance_ = 1;
    // In colour.
    std::optional<Stock> film_, paper_;
    std::optional<Printer> printer_;
    std::optional<Viewing> viewing_;
    Coupling coupling_;
    Triple shift_{};
    double print_log_ = 0;                  // log10 of the additional light in the enlarger
    Triple scan_grey_{}, scan_contrast_{};  // densities of a grey card, and how they rise with log exposure
    color::Matrix3 xyz_from_scan_{};
    // In black and white.
    std::vector<double> mono_h_, mono_density_, paper_h_, paper_density_;
    double paper_offset_ = 0;  // log10 exposure of the paper for no density; 0 without paper
    ProcessTables tables_;
};

// For `--list-papers`: the ways to see a film without paper.
std::string list_views();

}  // namespace latent::film
