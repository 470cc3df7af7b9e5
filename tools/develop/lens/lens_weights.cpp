#include "tools/develop/lens/lens_weights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/develop/lens/lens_rows.h"

namespace latent::develop {

namespace {

constexpr int kTimes = 256;

// Mean weight, and the mean of its square.
struct Moments {
    double mean = 0, square = 0;
    void add(double weight, double share) { mean += weight * share, square += weight * weight * share; }
    double kept() const { return square > 0 ? mean * mean / square : 0; }
};

}  // namespace

LensSums::LensSums(const std::vector<double>& values) : above_((kLensCells + 1) * kStride) {
    for (std::size_t row = 0; row < kLensCells; ++row) {
        double left = 0;
        for (std::size_t x = 0; x < kLensCells; ++x) {
            left += values[row * kLensCells + x];
            above_[(row + 1) * kStride + x + 1] = above_[row * kStride + x + 1] + left;
        }
    }
}

double LensSums::rows_between(std::size_t first, std::size_t last, double begin, double end) const {
    const double* const top = above_.data() + first * kStride;
    const double* const bottom = above_.data() + last * kStride;
    const auto left_of = [&](double x) {
        const int border = static_cast<int>(x);
        const double here = bottom[border] - top[border], next = bottom[border + 1] - top[border + 1];
        return here + (x - border) * (next - here);
    };
    return left_of(end) - left_of(begin);
}

std::string LensChoice::text() const {
    std::string text;
    const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
    if (!aperture_text.empty()) add("aperture " + aperture_text);
    if (!shutter_text.empty()) add("shutter " + shutter_text);
    if (shutter.frames > 1) add(fmt::format("frame {} of {}", shutter.frame + 1, shutter.frames));
    if (exposure_follows) add("exposure follows");
    return text;
}

Result<LensWeights> LensWeights::make(const sampledb::Job& job, const LensChoice& choice) {
    LensWeights weights;
    weights.follows_ = choice.exposure_follows;
    if (!choice.aperture.is_whole() || choice.is_refocused()) {
        if (Status s = check_lens_columns(job, "--aperture"); !s) return s.error();
        weights.lens_columns_ = lens_columns(job);
        if (!choice.aperture.is_whole() || job.light_paths_per_sample > 0)
            weights.set_aperture(choice.aperture, job.aspect_width, job.aspect_height);
        weights.film_shift_ = choice.film_shift;
        if (!(weights.mean_ > 0)) return usage_error("--aperture: no light passes");
    }
    if (!choice.shutter.is_whole()) {
        weights.time_column_ = place_of_fractions(job, "shutter");
        if (!weights.time_column_)
            return usage_error(
                fmt::format("{}: the files do not say when light met the lens; render the scene again with --aov "
                            "time (something in it must move)",
                            choice.shutter.frames > 1 ? "--frames" : "--shutter"));
        Result<ShutterCurve> curve = ShutterCurve::make(choice.shutter);
        if (!curve) return curve.error();
        weights.set_shutter(choice.shutter, *curve);
    }
    return weights;
}

void LensWeights::set_aperture(const Aperture& aperture, double film_width, double film_height) {
    const LensCells cells = cells_of(aperture);
    constexpr double kNearlyAll = 0.9;  // to find out which records are left out costs more than it saves
    double disk = 0;
    bool closed_somewhere = aperture.cat_eye > 0;
    std::vector<double> areas, passing, squares;
    for (std::size_t cell = 0; cell < cells.area.size(); ++cell) {
        const auto area = static_cast<double>(cells.area[cell]), weight = static_cast<double>(cells.transmission[cell]);
        disk += area;
        areas.push_back(area);
        passing.push_back(weight * area);
        squares.push_back(weight * weight * area);
        closed_somewhere = closed_somewhere || (area > 0 && weight == 0);
    }
    light_ = LensSums(passing);
    const double to_corner = std::sqrt(film_width * film_width + film_height * film_height) / 2;
    rim_u_ = static_cast<float>(aperture.cat_eye * film_width / to_corner);
    rim_v_ = static_cast<float>(-aperture.cat_eye * film_height / to_corner);
    const bool is_even = std::ranges::equal(passing, areas);
    if (!is_even) cells_ = cells.transmission;
    set_means(passing, squares, disk);
    leaves_out_ = closed_somewhere && mean_ < kNearlyAll;
}

// `passing`, `squares`: of each cell of the lens, its weight and the square of that, times its area.
void LensWeights::set_means(const std::vector<double>& passing, const std::vector<double>& squares, double disk) {
    constexpr std::size_t kSide = Patch::kAcross;
    const std::size_t across = rim_u_ != 0 ? kSide + 1 : 1;
    const auto place = [across](std::size_t k) { return across > 1 ? static_cast<double>(k) / kSide : 0.5; };
    const auto share = [across](std::size_t k) {  // share of the film, by the trapezoidal rule
        return across == 1 ? 1.0 : (k == 0 || k + 1 == across ? 0.5 : 1.0) / kSide;
    };
    std::vector<Moments> at_corners(across * across);  // where patches meet
    for (std::size_t row = 0; row < kLensCells; ++row) {
        std::array<Moments, kLensCells + 2> left{};  // one for each border of cells; one more is read at the end
        for (std::size_t x = 0; x < kLensCells; ++x) {
            const std::size_t cell = row * kLensCells + x;
            left[x + 1] = {left[x].mean + passing[cell] / disk, left[x].square + squares[cell] / disk};
        }
        const auto left_of = [&left](double x) {
            const auto border = static_cast<std::size_t>(static_cast<int>(x));
            const double part = x - static_cast<double>(border);
            const Moments &here = left[border], &next = left[border + 1];
            return Moments{here.mean + part * (next.mean - here.mean), here.square + part * (next.square - here.square)};
        };
        for (std::size_t j = 0; j < across; ++j) {
            const double chord = half_chord(middle_of_cell(row), place(j));
            for (std::size_t i = 0; i < across; ++i) {
                const auto [begin, end] = in_rear_rim(chord, place(i));
                const Moments to_begin = left_of(begin), to_end = left_of(end);
                Moments& corner = at_corners[j * across + i];
                corner.mean += to_end.mean - to_begin.mean;
                corner.square += to_end.square - to_begin.square;
            }
        }
    }
    double mean = 0, kept = 0;
    for (std::size_t j = 0; j < across; ++j) {
        for (std::size_t i = 0; i < across; ++i) {
            const Moments& corner = at_corners[j * across + i];
            mean += share(i) * share(j) * corner.mean;
            kept += share(i) * share(j) * corner.kept();
        }
    }
    mean_ *= mean;
    kept_ *= kept;
    if (across == 1) {
        even_mean_ *= static_cast<float>(at_corners[0].mean);
        return;
    }
    for (std::size_t j = 0; j < kSide; ++j) {
        for (std::size_t i = 0; i < kSide; ++i) {
            const auto at = [&](std::size_t x, std::size_t y) { return static_cast<float>(at_corners[y * across + x].mean); };
            const float corner = at(i, j), right = at(i + 1, j) - corner, down = at(i, j + 1) - corner;
            patches_.push_back({corner, right, down, at(i + 1, j + 1) - corner - right - down});
        }
    }
}

sampledb::ExtraSet LensWeights::columns() const {
    sampledb::ExtraSet columns;
    if (lens_columns_) columns.set((*lens_columns_)[0]).set((*lens_columns_)[1]);
    if (time_column_) columns.set(*time_column_);
    return columns;
}

// Half of the rear rim's chord at y on the lens, and from where to where it lets light pass there. That rim is the unit circle
// moved towards the centre of the picture's other side.
double LensWeights::half_chord(double y_on_lens, double v) const {
    if (rim_v_ == 0) return 2;  // as wide as the lens everywhere
    const double y = y_on_lens - (v - 0.5) * static_cast<double>(rim_v_);
    return std::sqrt(std::max(0.0, 1 - y * y));
}
std::array<double, 2> LensWeights::in_rear_rim(double half_chord, double u) const {
    constexpr double kPerCell = kLensCells / 2.0;
    const double x = (u - 0.5) * static_cast<double>(rim_u_);
    return {std::clamp((x - half_chord + 1) * kPerCell, 0.0, double{kLensCells}),
            std::clamp((x + half_chord + 1) * kPerCell, 0.0, double{kLensCells})};
}

// A refocused picture has records at (u, v) of those points of the lens alone for which the film that was rendered has them: the
// light through these, over that through all.
float LensWeights::share_on_film(double u, double v) const {
    const auto stays = [](double position, double shift) { return std::abs(position - 0.5) + std::abs(shift) <= 0.5; };
    if (stays(u, film_shift_[0]) && stays(v, film_shift_[1])) return 1;
    constexpr double kPerCell = kLensCells / 2.0;
    const auto cells = [](double position, double shift) {  // whose centres the film has
        if (shift == 0) return std::array<double, 2>{0, kLensCells};
        const double a = (position - 1) / shift, b = position / shift;
        const auto place = [](double x) { return std::floor(std::clamp((x + 1) * kPerCell, 0.0, double{kLensCells}) + 0.5); };
        return std::array{place(std::min(a, b)), place(std::max(a, b))};
    };
    const auto [x0, x1] = cells(u, film_shift_[0]);
    const auto [y0, y1] = cells(v, film_shift_[1]);
    const auto [seen, all] = light_between(static_cast<std::size_t>(y0), static_cast<std::size_t>(y1), x0, x1, u, v);
    return seen > 0 ? static_cast<float>(seen / all) : 1.0f;
}

// The light of a record at (u, v) through a rectangle of cells, and through all.
std::array<double, 2> LensWeights::light_between(std::size_t first, std::size_t last, double begin, double end, double u,
                                                 double v) const {
    if (rim_u_ == 0) return {light_.rows_between(first, last, begin, end), light_.rows_between(0, kLensCells, 0, kLensCells)};
    constexpr std::size_t kRows = 8;  // at once: their chords differ little
    double seen = 0, all = 0;
    for (std::size_t row = 0; row < kLensCells; row += kRows) {
        const auto [left, right] = in_rear_rim(half_chord((middle_of_cell(row) + middle_of_cell(row + kRows - 1)) / 2, v), u);
        all += light_.rows_between(row, row + kRows, left, right);
        const std::size_t top = std::max(row, first), bottom = std::min(row + kRows, last);
        const double from = std::max(left, begin), to = std::min(right, end);
        if (top < bottom && from < to) seen += light_.rows_between(top, bottom, from, to);
    }
    return {seen, all};
}

void LensWeights::set_shutter(const Shutter& shutter, const ShutterCurve& curve) {
    const double all = kTimes / static_cast<double>(shutter.frames), exposed = all * (1 - shutter.rolling);  // cells of time
    // The mean transmission over a cell of time that begins so many cells after a row's exposure.
    const auto transmission = [&](double after) {
        return static_cast<float>((curve.until((after + 1) / exposed) - curve.until(after / exposed)) * exposed);
    };
    const double begins = shutter.frame * all;
    const auto of_middle_row = [&](std::size_t time) {
        return transmission(static_cast<double>(time) - begins - shutter.rolling * all / 2);
    };
    Moments moments;
    for (std::size_t time = 0; time < kTimes; ++time) {
        open_.push_back(of_middle_row(time));
        leaves_out_ = leaves_out_ || open_.back() == 0;
        moments.add(static_cast<double>(open_.back()), 1.0 / kTimes);
    }
    if (shutter.rolling > 0) {
        leaves_out_ = true;
        steps_ = {static_cast<float>(kStepsPerCell), static_cast<float>(begins - 1) * kStepsPerCell,
                  static_cast<float>(shutter.rolling * all) * kStepsPerCell};
        open_.clear();
        for (double after = -1; after < exposed; after += 1.0 / kStepsPerCell) open_.push_back(transmission(after));
        open_.push_back(0);
    }
    open_.push_back(0);  // is read behind the last one
    const double mean = curve.all() * (1 - shutter.rolling) / shutter.frames;
    even_mean_ *= static_cast<float>(mean);
    mean_ *= mean;
    kept_ *= moments.kept();
}

PositionRect LensWeights::moved_from(const PositionRect& positions) const {
    const auto range = [](const PositionRange& along, double shift) {
        const double reach = std::abs(shift);
        const auto place = [](double x) { return static_cast<std::uint32_t>(std::clamp(x, 0.0, 1 - 0x1p-32) * 0x1p32); };
        return PositionRange{place(along.from * 0x1p-32 - reach), place((along.to + 1.0) * 0x1p-32 + reach)};
    };
    return {range(positions.u, film_shift_[0]), range(positions.v, film_shift_[1])};
}

void LensWeights::move(sampledb::Page& page, int level, const PixelRect& wanted, std::span<std::uint32_t> cells) const {
    std::array<std::vector<std::uint8_t>, 2> copies;
    const auto lens = [&](std::size_t axis) {
        return leading_bytes(page.extra[(*lens_columns_)[axis]], 0, page.count, copies[axis]);
    };
    const auto along = [&](std::size_t axis, std::int64_t first, std::int64_t count) {
        return AxisMove{static_cast<float>(film_shift_[axis]), static_cast<std::uint32_t>(first),
                        static_cast<std::uint32_t>(count)};
    };
    move_positions(along(0, wanted.x0, wanted.width()), along(1, wanted.y0, wanted.height()), level, lens(0), lens(1),
                   page.u.data(), page.v.data(), cells);
}

LensTables LensWeights::tables() const {
    LensTables tables;
    if (!cells_.empty()) tables.cells = cells_.data();
    const auto first = static_cast<float>(middle_of_cell(0));
    if (rim_u_ != 0) tables.rim = {first + rim_u_ / 2, first + rim_v_ / 2, rim_u_, rim_v_};
    if (!open_.empty()) tables.shutter = {open_.data(), static_cast<float>(open_.size() - 2), steps_};
    if (!patches_.empty()) tables.patches = patches_.data();
    tables.even_mean = even_mean_;
    return tables;
}

// A camera image is divided by the sum of shares, and so by the mean weight; a light image is not.
void LensWeights::factors(const sampledb::Page& page, std::size_t begin, std::size_t end, Factors& out) const {
    const bool is_camera = page.record_class == sampledb::RecordClass::kCamera;
    const auto cells = [&](std::size_t column, std::vector<std::uint8_t>& copies) {
        return leading_bytes(page.extra[column], begin, end, copies);
    };
    LensRows rows{.u = &page.u[begin], .v = &page.v[begin]};
    if (lens_closes()) rows.x = cells((*lens_columns_)[0], out.cells[0]), rows.y = cells((*lens_columns_)[1], out.cells[1]);
    if (time_column_) rows.time = cells(*time_column_, out.cells[2]);
    out.share.resize(end - begin);
    out.value.resize(end - begin);
    const LightFactor light = is_camera != follows_ ? LightFactor::kWeight
                              : is_camera           ? LightFactor::kTimesMean
                                                    : LightFactor::kOverMean;
    weigh_rows(tables(), rows, light, out.share, out.value);
    if (is_camera) return;
    std::ranges::fill(out.share, 0.0f);
    if (!moves_records() || light_.empty()) return;
    for (std::size_t i = 0; i < out.value.size(); ++i) {
        if (out.value[i] > 0) out.value[i] /= share_on_film(page.u[begin + i] * 0x1p-32, page.v[begin + i] * 0x1p-32);
    }
}

}  // namespace latent::develop
