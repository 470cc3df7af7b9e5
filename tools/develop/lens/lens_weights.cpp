#include "tools/develop/lens/lens_weights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace latent::develop {

namespace {

constexpr int kTimes = 256;

// Mean weight, and the mean of its square.
struct Moments {
    double mean = 0, square = 0;
    void add(double weight, double share) { mean += weight * share, square += weight * weight * share; }
    double kept() const { return square > 0 ? mean * mean / square : 0; }
};

float fraction_of(std::uint32_t position) { return static_cast<float>(position) * 0x1p-32f; }

FilmRows film_rows(const sampledb::Page& page, std::size_t begin) { return {page.u.data() + begin, page.v.data() + begin}; }

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

double LensSums::within(const LensRectangle& cells) const {
    const double* const top = above_.data() + cells.first * kStride;
    const double* const bottom = above_.data() + cells.last * kStride;
    const auto left_of = [&](double x) {
        const int border = static_cast<int>(x);
        const double here = bottom[border] - top[border], next = bottom[border + 1] - top[border + 1];
        return here + (x - border) * (next - here);
    };
    return left_of(cells.end) - left_of(cells.begin);
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
        weights.set_focus(choice.film_shift);
        if (!(weights.mean_ > 0)) return usage_error("--aperture: no light passes");
    }
    if (!choice.shutter.is_whole()) {
        weights.time_column_ = place_of_fractions(job, "shutter");
        if (!weights.time_column_)
            return usage_error(
                fmt::format("{}: the files do not say when light met the lens; render the scene again with --aov "
                            "time; something in it must move",
                            choice.shutter.frames > 1 ? "--frames" : "--shutter"));
        Result<ShutterCurve> curve = ShutterCurve::make(choice.shutter);
        if (!curve) return curve.error();
        weights.set_shutter(choice.shutter, *std::move(curve));
    }
    return weights;
}

void LensWeights::set_aperture(const Aperture& aperture, double film_width, double film_height) {
    const LensCells cells = cells_of(aperture);
    constexpr double kNearlyAll = 0.9;  // to find out which records are left out costs more than it saves
    double disk = 0;
    bool closed_somewhere = aperture.cat_eye > 0;
    std::vector<double> passing, squares;
    for (std::size_t cell = 0; cell < cells.area.size(); ++cell) {
        const auto area = static_cast<double>(cells.area[cell]), weight = static_cast<double>(cells.transmission[cell]);
        disk += area;
        passing.push_back(weight * area);
        squares.push_back(weight * weight * area);
        closed_somewhere = closed_somewhere || (area > 0 && weight == 0);
    }
    for (std::vector<double>* const values : {&passing, &squares}) {
        for (double& value : *values) value /= disk;
    }
    light_ = LensSums(passing);
    const double to_corner = std::sqrt(film_width * film_width + film_height * film_height) / 2;
    rim_u_ = static_cast<float>(aperture.cat_eye * film_width / to_corner);
    rim_v_ = static_cast<float>(-aperture.cat_eye * film_height / to_corner);
    if (!aperture.is_whole()) cells_ = cells.transmission;
    set_means(LensSums(squares));
    leaves_out_ = closed_somewhere && mean_ < kNearlyAll;
}

void LensWeights::set_means(const LensSums& square_sums) {
    const std::size_t across = rim_u_ != 0 ? kPatches + 1 : 1;
    const auto place = [across](std::size_t k) { return across > 1 ? static_cast<float>(k) / kPatches : 0.5f; };
    const auto share = [across](std::size_t k) {  // of the film, by the trapezoidal rule
        return across == 1 ? 1.0 : (k == 0 || k + 1 == across ? 0.5 : 1.0) / kPatches;
    };
    std::vector<float> means;  // at the corners of the patches
    double mean = 0, kept = 0;
    for (std::size_t j = 0; j < across; ++j) {
        for (std::size_t i = 0; i < across; ++i) {
            const auto all_of = [&](const LensSums& sums, std::size_t rows) {
                return between_rims(sums, kWholeLens, rows, place(i), place(j));
            };
            constexpr std::size_t kRows = 8;  // of what is only reported
            const double here = all_of(light_, 1), area = share(i) * share(j);
            means.push_back(static_cast<float>(here));
            mean += area * here;
            kept += area * Moments{all_of(light_, kRows), all_of(square_sums, kRows)}.kept();
        }
    }
    mean_ *= mean;
    kept_ *= kept;
    constexpr std::size_t kSide = kPatches;
    for (std::size_t j = 0; j < kSide; ++j) {
        for (std::size_t i = 0; i < kSide; ++i) {
            const auto at = [&](std::size_t x, std::size_t y) { return means[across == 1 ? 0 : y * (kSide + 1) + x]; };
            const float corner = at(i, j), right = at(i + 1, j) - corner, down = at(i, j + 1) - corner;
            patches_.push_back({corner, right, down, at(i + 1, j + 1) - corner - right - down});
        }
    }
}

void LensWeights::set_focus(const std::array<double, 2>& film_shift) {
    film_shift_ = film_shift;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        for (std::size_t cell = 0; cell < kLensCells; ++cell)
            moves_[axis][cell] = static_cast<std::int32_t>(
                std::floor(std::clamp(film_shift[axis] * middle_of_cell(cell), -1.0, 1 - 0x1p-31) * 0x1p31));
    }
}

sampledb::ExtraSet LensWeights::columns() const {
    sampledb::ExtraSet columns;
    if (lens_columns_) columns.set((*lens_columns_)[0]).set((*lens_columns_)[1]);
    if (time_column_) columns.set(*time_column_);
    return columns;
}

// The sum over those cells of a rectangle through which the rear rim lets a record at (u, v) pass: it is the unit circle, moved
// towards the centre of the picture's other side. Of so many rows at once, the chord of the middle counts.
double LensWeights::between_rims(const LensSums& sums, const LensRectangle& cells, std::size_t rows, float u, float v) const {
    if (rim_u_ == 0) return sums.within(cells);
    constexpr double kPerCell = kLensCells / 2.0;
    const double middle = static_cast<double>((u - 0.5f) * rim_u_), height = static_cast<double>((v - 0.5f) * rim_v_);
    double sum = 0;
    for (std::size_t row = cells.first; row < cells.last; row += rows) {
        const std::size_t next = std::min(row + rows, cells.last);
        const double y = (middle_of_cell(row) + middle_of_cell(next - 1)) / 2 - height;
        const double half_chord = std::sqrt(std::max(0.0, 1 - y * y));
        const double from = std::max((middle - half_chord + 1) * kPerCell, cells.begin),
                     to = std::min((middle + half_chord + 1) * kPerCell, cells.end);
        if (from < to) sum += sums.within({row, next, from, to});
    }
    return sum;
}

// The mean weight of records at the places of those of a page.
void LensWeights::means_at(const sampledb::Page& page, std::size_t begin, std::span<float> means) const {
    if (patches_.empty()) {
        std::ranges::fill(means, time_mean_);
        return;
    }
    on_patches(patches_.data(), film_rows(page, begin), time_mean_, means);
}

// A refocused picture has records at (u, v) of those points of the lens alone for which the film that was rendered has them. What
// passes through these, when `mean` passes through all.
float LensWeights::passes_on_film(float u, float v, float mean) const {
    const auto is_inside = [](float position, double shift) {
        return std::abs(shift) <= static_cast<double>(std::min(position, 1 - position));
    };
    if (is_inside(u, film_shift_[0]) && is_inside(v, film_shift_[1])) return mean;
    constexpr double kPerCell = kLensCells / 2.0;
    const auto cells = [](double position, double shift) {  // whose centres the film has
        if (shift == 0) return std::array<double, 2>{0, kLensCells};
        const double a = (position - 1) / shift, b = position / shift;
        const auto place = [](double x) { return std::floor(std::clamp((x + 1) * kPerCell, 0.0, double{kLensCells}) + 0.5); };
        return std::array{place(std::min(a, b)), place(std::max(a, b))};
    };
    const auto [x0, x1] = cells(static_cast<double>(u), film_shift_[0]);
    const auto [y0, y1] = cells(static_cast<double>(v), film_shift_[1]);
    constexpr std::size_t kRows = 16;
    const double light = between_rims(light_, {static_cast<std::size_t>(y0), static_cast<std::size_t>(y1), x0, x1}, kRows, u, v);
    return light > 0 ? static_cast<float>(light) * time_mean_ : mean;
}

void LensWeights::set_shutter(const Shutter& shutter, ShutterCurve curve) {
    curve_ = std::move(curve);
    frame_ = shutter.frame, frames_ = shutter.frames, rolling_ = shutter.rolling;
    Moments moments;
    for (std::size_t time = 0; time < open_.size(); ++time) {
        open_[time] = open(time, 0.5);
        leaves_out_ = leaves_out_ || open_[time] == 0;
        moments.add(static_cast<double>(open_[time]), 1.0 / kTimes);
    }
    leaves_out_ = leaves_out_ || rolling_ > 0;
    const double mean = curve_->all() * (1 - rolling_) / frames_;
    time_mean_ = static_cast<float>(mean);
    mean_ *= mean;
    kept_ *= moments.kept();
}

// The mean transmission over 1/256 of the exposure, for a row of the picture at v.
float LensWeights::open(std::size_t time, double v) const {
    const double begins = frame_ + v * rolling_, takes = 1 - rolling_;
    const auto moment = [&](int at) { return (at * frames_ / kTimes - begins) / takes; };  // 0 to 1: while the row is exposed
    const int at = static_cast<int>(time);
    const double from = moment(at), to = moment(at + 1);
    if (to <= 0 || from >= 1) return 0;
    return static_cast<float>((curve_->until(to) - curve_->until(from)) * takes / frames_ * kTimes);
}

std::array<LeadingBytes, 2> LensWeights::its_lens(const sampledb::Page& page, std::size_t begin, std::size_t end) const {
    const auto along = [&](std::size_t column) { return LeadingBytes(page.extra[column], begin, end); };
    return {along((*lens_columns_)[0]), along((*lens_columns_)[1])};
}

void LensWeights::move(sampledb::Page& page, int level, const PixelRect& wanted, std::uint32_t* cells) const {
    const std::array<LeadingBytes, 2> lens = its_lens(page, 0, page.count);
    move_on_film(moves_, {lens[0].data(), lens[1].data()}, level, wanted, {page.u.data(), page.count}, page.v.data(), cells);
}

void LensWeights::through_lens(const sampledb::Page& page, std::size_t begin, std::span<float> weights) const {
    const std::array<LeadingBytes, 2> columns = its_lens(page, begin, begin + weights.size());
    const LensRows lens{columns[0].data(), columns[1].data()};
    transmissions(cells_.data(), lens, weights);
    if (rim_u_ != 0) pass_rear_rim({-rim_u_ / 2, -rim_v_ / 2, rim_u_, rim_v_}, film_rows(page, begin), lens, weights);
}

void LensWeights::through_shutter(const sampledb::Page& page, std::size_t begin, std::span<float> weights) const {
    const LeadingBytes times(page.extra[*time_column_], begin, begin + weights.size());
    const std::uint8_t* const time = times.data();
    if (rolling_ == 0) {
        for (std::size_t i = 0; i < weights.size(); ++i) weights[i] *= open_[time[i]];
    } else {
        for (std::size_t i = 0; i < weights.size(); ++i) weights[i] *= open(time[i], page.v[begin + i] * 0x1p-32);
    }
}

// A camera image is divided by the sum of shares, and so by the mean weight; a light image is not.
void LensWeights::factors(const sampledb::Page& page, std::size_t begin, std::size_t end, Factors& out) const {
    out.share.resize(end - begin);
    if (cells_.empty()) {
        std::ranges::fill(out.share, 1.0f);
    } else {
        through_lens(page, begin, out.share);
    }
    if (time_column_) through_shutter(page, begin, out.share);
    out.value = out.share;
    float* const value = out.value.data();
    const std::size_t count = end - begin;
    const bool is_camera = page.record_class == sampledb::RecordClass::kCamera;
    if (is_camera && !follows_) return;
    out.mean.resize(count);
    means_at(page, begin, out.mean);
    const float* const mean = out.mean.data();
    if (is_camera) {
        for (std::size_t i = 0; i < count; ++i) value[i] *= mean[i];
        return;
    }
    std::ranges::fill(out.share, 0.0f);
    for (std::size_t i = 0; i < count; ++i) {
        if (!(value[i] > 0)) continue;
        const float passes =
            moves_records() ? passes_on_film(fraction_of(page.u[begin + i]), fraction_of(page.v[begin + i]), mean[i]) : mean[i];
        value[i] *= (follows_ ? mean[i] : 1) / passes;
    }
}

}  // namespace latent::develop
