// tools/develop/lens/lens_weights.h: a smaller aperture and a shorter exposure than those rendered, as weights of records.
// docs/developing.md, "Lens and shutter".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "sampledb/data/job.h"
#include "sampledb/data/page.h"
#include "tools/develop/film/film_grid.h"
#include "tools/develop/lens/aperture.h"
#include "tools/develop/lens/lens_columns.h"
#include "tools/develop/lens/lens_rows.h"
#include "tools/develop/lens/shutter.h"

namespace latent::develop {

struct LensChoice {
    Aperture aperture{};
    Shutter shutter{};
    bool exposure_follows = false;  // less light makes a darker picture; else it is as bright as that of the whole lens
    std::string aperture_text{}, shutter_text{};  // as they were given

    std::array<double, 2> film_shift{};  // what focusing elsewhere moves: recorded_lens.h

    bool is_refocused() const { return film_shift != std::array<double, 2>{}; }
    bool is_whole() const { return aperture.is_whole() && shutter.is_whole() && !is_refocused(); }
    std::string text() const;  // "aperture 0.35; shutter 0.2:0.5"
};

// Sums of a value over cells of the lens.
class LensSums {
 public:
    LensSums() = default;
    explicit LensSums(const std::vector<double>& values);  // kLensCells * kLensCells
    bool empty() const { return above_.empty(); }
    // The sum over the rows from first to before last, from one place to another, in cells. Parts of cells count in part.
    double rows_between(std::size_t first, std::size_t last, double begin, double end) const;

 private:
    static constexpr std::size_t kStride = kLensCells + 2;  // one more border, which a place at the end reads
    std::vector<double> above_{};                           // for each corner of cells, the sum above it and to its left
};

// A record's weight is the transmission of the aperture in its cell of the lens, times that of the shutter in its 1/256 of the
// exposure; both are means over the cell. Thread-safe.
class LensWeights {
 public:
    // Errors: kUsage: the job lacks the columns, or the choice lets no light through; of the shutter's file.
    static Result<LensWeights> make(const sampledb::Job& job, const LensChoice& choice);

    // Those that the functions below read.
    sampledb::ExtraSet columns() const;

    // Whether any record of a class may have another factor than 1.
    bool weighs(sampledb::RecordClass record_class) const {
        return record_class == sampledb::RecordClass::kLight || lens_closes() || time_column_ || follows_;
    }
    // What the values and the shares of rows are multiplied by; the share of a light record is 0.
    struct Factors {
        std::vector<float> value, share;
        std::array<std::vector<std::uint8_t>, 3> cells;  // for their making: of x, y and time
    };
    void factors(const sampledb::Page& page, std::size_t begin, std::size_t end, Factors& out) const;

    // Whether many weights are 0.
    bool leaves_records_out() const { return leaves_out_; }

    // Whether the lens is focused elsewhere.
    bool moves_records() const { return film_shift_ != std::array<double, 2>{}; }
    // Where records that lie in `positions` may be moved to.
    PositionRect moved_from(const PositionRect& positions) const;
    // Moves the records of a page along the film by its shift x their points of the lens. `cells`, of all rows: the numbers of
    // their new cells, as move_positions gives them.
    void move(sampledb::Page& page, int level, const PixelRect& wanted, std::span<std::uint32_t> cells) const;

    double mean() const { return mean_; }  // the mean weight of camera records
    // (sum w)^2 / (n sum w^2): a picture from this fraction of the samples, all with the same weight, would be as noisy.
    double kept() const { return kept_; }

 private:
    bool lens_closes() const { return !cells_.empty() || rim_u_ != 0; }
    void set_aperture(const Aperture& aperture, double film_width, double film_height);
    void set_shutter(const Shutter& shutter, const ShutterCurve& curve);
    void set_means(const std::vector<double>& passing, const std::vector<double>& squares, double disk);
    LensTables tables() const;
    float share_on_film(double u, double v) const;
    std::array<double, 2> light_between(std::size_t first, std::size_t last, double begin, double end, double u, double v) const;
    double half_chord(double y_on_lens, double v) const;
    std::array<double, 2> in_rear_rim(double half_chord, double u) const;

    bool follows_ = false, leaves_out_ = false;
    double mean_ = 1, kept_ = 1;

    std::optional<std::array<std::size_t, 2>> lens_columns_{};  // among the extra columns
    std::vector<float> cells_{};                                // transmission; none: 1
    float rim_u_ = 0, rim_v_ = 0;                               // distance of the rims, in radii per unit of u and of v
    std::vector<Patch> patches_{};                              // the mean over the lens, row by row; none: the same everywhere
    float even_mean_ = 1;                                       // mean of what is the same everywhere

    LensSums light_{};  // through cells; none: of the whole lens, in jobs without light records

    std::array<double, 2> film_shift_{};  // along u and v, per radius of the lens

    std::optional<std::size_t> time_column_{};
    // Transmission, by cells of time; of a rolling shutter in shorter steps, which begin at -1 cell: between them it is linear, so
    // that its sum over the cells is the same for all rows. One more is 0.
    static constexpr int kStepsPerCell = 16;
    std::vector<float> open_{};
    RowSteps steps_{};
};

}  // namespace latent::develop
