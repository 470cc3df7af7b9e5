#include "tools/develop/lens_weights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/develop/lens_columns.h"

namespace latent::develop {

namespace {

constexpr std::size_t kTimes = 256;
constexpr std::size_t kMeansAcross = 33;  // points of the film, from border to border

// Mean weight, and the mean of its square.
struct Moments {
    double mean = 0, square = 0;
    void add(double weight, double share) { mean += weight * share, square += weight * weight * share; }
    double kept() const { return square > 0 ? mean * mean / square : 0; }
};

}  // namespace

RowSums::RowSums(const std::vector<double>& values) {
    before_.reserve(kLensCells * (kLensCells + 1));
    for (std::size_t row = 0; row < kLensCells; ++row) {
        before_.push_back(0);
        for (std::size_t x = 0; x < kLensCells; ++x) before_.push_back(before_.back() + values[row * kLensCells + x]);
    }
}

double RowSums::between(std::size_t row, double begin, double end) const {
    const auto before = [&](double x) {
        const double border = std::floor(x);
        const double* const at = &before_[row * (kLensCells + 1) + static_cast<std::size_t>(border)];
        return x == border ? at[0] : at[0] + (x - border) * (at[1] - at[0]);
    };
    return before(end) - before(begin);
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
        weights.set_aperture(choice.aperture, job.aspect_width, job.aspect_height, choice.film_shift);
        if (!(weights.mean_ > 0)) return usage_error("--aperture: no light passes");
    }
    if (!choice.shutter.is_whole()) {
        weights.time_column_ = place_of_fractions(job, "shutter");
        if (!weights.time_column_)
            return usage_error(
                "--shutter: the files do not say when light met the lens; render the scene again with --aov time; something in it "
                "must move");
        Result<ShutterCurve> curve = ShutterCurve::make(choice.shutter);
        if (!curve) return curve.error();
        weights.set_shutter(choice.shutter, *std::move(curve));
    }
    return weights;
}

void LensWeights::set_aperture(const Aperture& aperture, double film_width, double film_height,
                               const std::array<double, 2>& film_shift) {
    LensCells cells = cells_of(aperture);
    cells_ = std::move(cells.transmission);
    double disk = 0;
    std::vector<double> passing, squares;
    for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
        const auto area = static_cast<double>(cells.area[cell]), weight = static_cast<double>(cells_[cell]);
        disk += area;
        passing.push_back(weight * area);
        squares.push_back(weight * weight * area);
        leaves_out_ = leaves_out_ || (area > 0 && weight == 0);
    }
    const RowSums light(passing), square_sums(squares);
    leaves_out_ = leaves_out_ || aperture.cat_eye > 0;
    const double to_corner = std::sqrt(film_width * film_width + film_height * film_height) / 2;
    rim_u_ = static_cast<float>(aperture.cat_eye * film_width / to_corner);
    rim_v_ = static_cast<float>(-aperture.cat_eye * film_height / to_corner);
    const std::size_t across = aperture.cat_eye > 0 ? kMeansAcross : 1;
    double mean = 0, kept = 0;
    for (std::size_t i = 0; i < across * across; ++i) {
        const auto place = [across](std::size_t k) { return across > 1 ? static_cast<float>(k) / (kMeansAcross - 1) : 0.5f; };
        const float u = place(i % across), v = place(i / across);
        Moments here;
        for (std::size_t row = 0; row < kLensCells; ++row) {
            const auto [begin, end] = in_rear_rim(row, u, v);
            here.mean += light.between(row, begin, end) / disk;
            here.square += square_sums.between(row, begin, end) / disk;
        }
        means_.push_back(static_cast<float>(here.mean));
        const auto share = [across](std::size_t k) {  // of the film, by the trapezoidal rule
            return across == 1 ? 1.0 : (k == 0 || k + 1 == across ? 0.5 : 1.0) / (kMeansAcross - 1);
        };
        const double area = share(i % across) * share(i / across);
        mean += area * here.mean;
        kept += area * here.kept();
    }
    mean_ *= mean;
    kept_ *= kept;
    film_shift_ = film_shift;
    if (film_shift != std::array<double, 2>{}) light_ = light;
}

// The share of a cell that lies in the rear rim, the unit circle moved towards the centre of the picture's other side; its edge
// counts as straight within a cell.
float LensWeights::between_rims(std::size_t cell, float u, float v) const {
    if (rim_u_ == 0) return 1;
    constexpr float kPerCell = kLensCells / 2.0f;
    const float x = (static_cast<float>(cell % kLensCells) + 0.5f) / kPerCell - 1 - (u - 0.5f) * rim_u_,
                y = (static_cast<float>(cell / kLensCells) + 0.5f) / kPerCell - 1 - (v - 0.5f) * rim_v_;
    return std::clamp((1 - std::sqrt(x * x + y * y)) * kPerCell + 0.5f, 0.0f, 1.0f);
}

// The same for a row of cells at once: from where to where the rim lets light pass.
std::array<double, 2> LensWeights::in_rear_rim(std::size_t row, float u, float v) const {
    if (rim_u_ == 0) return {0, kLensCells};
    constexpr double kPerCell = kLensCells / 2.0;
    const double x = static_cast<double>((u - 0.5f) * rim_u_),
                 y = (static_cast<double>(row) + 0.5) / kPerCell - 1 - static_cast<double>((v - 0.5f) * rim_v_);
    const double half = std::sqrt(std::max(0.0, 1 - y * y));
    return {std::clamp((x - half + 1) * kPerCell, 0.0, double{kLensCells}),
            std::clamp((x + half + 1) * kPerCell, 0.0, double{kLensCells})};
}

float LensWeights::lens_mean(float u, float v) const {
    if (means_.size() == 1) return means_[0];
    const float x = u * (kMeansAcross - 1), y = v * (kMeansAcross - 1);
    const std::size_t i = std::min(static_cast<std::size_t>(x), kMeansAcross - 2),
                      j = std::min(static_cast<std::size_t>(y), kMeansAcross - 2);
    const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j);
    const float* const upper = means_.data() + j * kMeansAcross + i;
    const float* const lower = upper + kMeansAcross;
    return (upper[0] * (1 - fx) + upper[1] * fx) * (1 - fy) + (lower[0] * (1 - fx) + lower[1] * fx) * fy;
}

// A refocused picture has records at (u, v) of those points of the lens alone for which the film that was rendered has them: the
// light through these, over that through all.
float LensWeights::share_on_film(float u, float v) const {
    constexpr double kPerCell = kLensCells / 2.0;
    const auto cells = [](double position, double shift) {  // whose centres the film has
        if (shift == 0) return std::array<double, 2>{0, kLensCells};
        const double a = (position - 1) / shift, b = position / shift;
        const auto place = [](double x) { return std::floor(std::clamp((x + 1) * kPerCell, 0.0, double{kLensCells}) + 0.5); };
        return std::array{place(std::min(a, b)), place(std::max(a, b))};
    };
    const auto [x0, x1] = cells(static_cast<double>(u), film_shift_[0]);
    const auto [y0, y1] = cells(static_cast<double>(v), film_shift_[1]);
    if (x0 == 0 && y0 == 0 && x1 == kLensCells && y1 == kLensCells) return 1;
    double all = 0, seen = 0;
    for (std::size_t row = 0; row < kLensCells; ++row) {
        const auto [begin, end] = in_rear_rim(row, u, v);
        all += light_.between(row, begin, end);
        const double first = std::max(begin, x0), last = std::min(end, x1), y = static_cast<double>(row);
        if (y >= y0 && y < y1 && first < last) seen += light_.between(row, first, last);
    }
    return seen > 0 ? static_cast<float>(seen / all) : 1.0f;
}

void LensWeights::set_shutter(const Shutter& shutter, ShutterCurve curve) {
    curve_ = std::move(curve);
    frame_ = shutter.frame, frames_ = shutter.frames, rolling_ = shutter.rolling;
    Moments moments;
    for (std::size_t time = 0; time < kTimes; ++time) {
        open_[time] = open(time, 0.5f);
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
float LensWeights::open(std::size_t time, float v) const {
    const double begins = frame_ + static_cast<double>(v) * rolling_, takes = 1 - rolling_;
    const auto passed = [&](std::size_t at) {
        return curve_->until((static_cast<double>(at) / kTimes * frames_ - begins) / takes);
    };
    return static_cast<float>((passed(time + 1) - passed(time)) * takes / frames_ * kTimes);
}

LensWeights::Factors LensWeights::operator()(const sampledb::Page& page, std::size_t row) const {
    float weight = 1, mean = 1;
    const float u = static_cast<float>(page.u[row]) * 0x1p-32f, v = static_cast<float>(page.v[row]) * 0x1p-32f;
    if (lens_columns_) {
        const std::size_t cell =
            leading_byte(page.extra[(*lens_columns_)[1]], row) * kLensCells + leading_byte(page.extra[(*lens_columns_)[0]], row);
        weight = cells_[cell];
        if (rim_u_ != 0 && weight > 0) weight *= between_rims(cell, u, v);
        mean = lens_mean(u, v);
    }
    if (time_column_) {
        const std::size_t time = leading_byte(page.extra[*time_column_], row);
        weight *= rolling_ > 0 ? open(time, v) : open_[time];
        mean *= time_mean_;
    }
    const bool part_is_off_film = !light_.empty() && page.record_class == sampledb::RecordClass::kLight && weight > 0;
    return factors_of(page.record_class, weight, mean, part_is_off_film ? share_on_film(u, v) : 1);
}

// A camera image is divided by the sum of shares, and so by the mean weight; a light image is not.
LensWeights::Factors LensWeights::factors_of(sampledb::RecordClass record_class, float weight, float mean,
                                             float share_on_film) const {
    if (record_class == sampledb::RecordClass::kCamera) return {follows_ ? weight * mean : weight, weight};
    return {weight == 0 ? 0 : weight / (follows_ ? 1 : mean) / share_on_film, 0};
}

void LensWeights::factors(const sampledb::Page& page, std::size_t begin, std::size_t end, std::vector<Factors>& out) const {
    out.resize(end - begin);
    if (!is_same_all_over_the_film()) {
        for (std::size_t row = begin; row < end; ++row) out[row - begin] = (*this)(page, row);
        return;
    }
    const float mean = (means_.empty() ? 1 : means_[0]) * time_mean_;
    const auto bytes = [&](std::size_t column) { return LeadingBytes(page.extra[column]); };
    const LeadingBytes x = lens_columns_ ? bytes((*lens_columns_)[0]) : LeadingBytes(),
                       y = lens_columns_ ? bytes((*lens_columns_)[1]) : LeadingBytes(),
                       time = time_column_ ? bytes(*time_column_) : LeadingBytes();
    for (std::size_t row = begin; row < end; ++row) {
        const float through = lens_columns_ ? cells_[y[row] * kLensCells + x[row]] : 1, open = time_column_ ? open_[time[row]] : 1;
        out[row - begin] = factors_of(page.record_class, through * open, mean, 1);
    }
}

}  // namespace latent::develop
