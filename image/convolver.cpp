#include "image/convolver.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

namespace latent::image {
namespace {

// A symmetric kernel has a symmetric spectrum, of which half the rows do.
bool is_stored(std::size_t row) { return static_cast<int>(row) <= SquareFourier::negative(static_cast<int>(row)); }
std::size_t stored_row(std::size_t row) { return row < 2 ? row : row - std::bit_floor(row) / 2 + 1; }

std::size_t negative(std::size_t place) { return static_cast<std::size_t>(SquareFourier::negative(static_cast<int>(place))); }

}  // namespace

// The size that takes least time.
int Convolver::size_for(int radius, const Rect& picture) {
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (int log2 = 5; log2 <= 12; ++log2) {
        const int size = 1 << log2, step = size - 2 * radius;
        if (step < size / 4) continue;
        const auto tiles = [&](int length) { return (length + step - 1) / step; };
        const double time = static_cast<double>(tiles(picture.width())) * tiles(picture.height()) * size * size * log2;
        if (time >= least) continue;
        least = time;
        best = size;
    }
    assert(best > 0);
    return best;
}

std::size_t Convolver::bytes(int radius, const Rect& picture) {
    const auto size = static_cast<std::size_t>(size_for(radius, picture)), side = 2 * static_cast<std::size_t>(radius) + 2;
    return 3 * sizeof(float) * (size * size + (size / 2 + 1) * size + side * side);
}

Convolver::Convolver(const Kernel& kernel, const Rect& picture)
    : picture_(picture), radius_(kernel.radius()), size_(size_for(radius_, picture)), fourier_(size_) {
    const auto size = static_cast<std::size_t>(size_), side = static_cast<std::size_t>(kernel.side());
    std::vector<float> re(size * size), im(size * size);
    const float scale = 1.0F / (static_cast<float>(size_) * static_cast<float>(size_));
    for (std::size_t c = 0; c < 3; ++c) {
        std::ranges::fill(re, 0.0F);
        std::ranges::fill(im, 0.0F);
        std::vector<double> columns(side);
        sums_[c].assign((side + 1) * (side + 1), 0.0F);
        for (int y = -radius_; y <= radius_; ++y) {
            double row = 0;
            for (int x = -radius_; x <= radius_; ++x) {
                const float weight = x == 0 && y == 0 ? 0.0F : kernel.at(c, x, y);
                re[static_cast<std::size_t>(y & (size_ - 1)) * size + static_cast<std::size_t>(x & (size_ - 1))] = weight * scale;
                const int from_left = x + radius_;
                const auto column = static_cast<std::size_t>(from_left);
                row += static_cast<double>(weight);
                columns[column] += row;
                sums_[c][static_cast<std::size_t>(y + radius_ + 1) * (side + 1) + column + 1] = static_cast<float>(columns[column]);
            }
        }
        all_[c] = sums_[c].back();
        if (c == 2 && std::ranges::all_of(re, [](float weight) { return weight == 0; })) continue;
        fourier_.forward(re.data(), im.data());
        spectrum_[c].resize((size / 2 + 1) * size);
        for (std::size_t row = 0; row < size; ++row) {
            if (is_stored(row)) std::copy_n(&re[row * size], size, &spectrum_[c][stored_row(row) * size]);
        }
    }
}

// Two real pictures as one complex: F = A + i B has the spectra A = (F(u) + F*(-u)) / 2 and B = (F(u) - F*(-u)) / 2i.
void Convolver::multiply(std::vector<float>& re, std::vector<float>& im, std::size_t first, std::size_t second) const {
    const auto size = static_cast<std::size_t>(size_);
    tbb::parallel_for(std::size_t{0}, size, [&](std::size_t row) {
        if (!is_stored(row)) return;
        const float* a = &spectrum_[first][stored_row(row) * size];
        const float* b = &spectrum_[second][stored_row(row) * size];
        const std::size_t other = negative(row);
        for (std::size_t i = 0; i < size; ++i) {
            const std::size_t j = negative(i);
            if (row == other && j < i) continue;
            const std::size_t u = row * size + i, v = other * size + j;
            const float s = (a[i] + b[i]) * 0.5F, m = (a[i] - b[i]) * 0.5F;
            const float ur = re[u], ui = im[u], vr = re[v], vi = im[v];
            re[u] = s * ur + m * vr;
            im[u] = s * ui - m * vi;
            re[v] = s * vr + m * ur;
            im[v] = s * vi - m * ui;
        }
    });
}

void Convolver::spread(Planes& planes, const Take& take) const {
    const auto run = [&](std::vector<float>& re, std::vector<float>& im, std::size_t first, std::size_t second) {
        fourier_.forward(re.data(), im.data());
        multiply(re, im, first, second);
        fourier_.inverse(re.data(), im.data());
    };
    run(planes[0], planes[1], 0, 1);
    take(0, planes[0].data());
    take(1, planes[1].data());
    std::ranges::fill(planes[0], 0.0F);
    if (spectrum_[2].empty()) {  // nothing spreads
        std::ranges::fill(planes[2], 0.0F);
    } else {
        run(planes[2], planes[0], 2, 2);
    }
    take(2, planes[2].data());
}

float Convolver::given_away(std::size_t channel, int x, int y) const {
    const std::size_t side = 2 * static_cast<std::size_t>(radius_) + 2;
    const auto end = [&](int distance) {
        const int within = std::min(distance, radius_) + radius_;
        return static_cast<std::size_t>(within);
    };
    const std::size_t left = static_cast<std::size_t>(radius_ - std::min(x - picture_.x0, radius_)),
                      right = end(picture_.x1 - 1 - x) + 1,
                      top = static_cast<std::size_t>(radius_ - std::min(y - picture_.y0, radius_)),
                      bottom = end(picture_.y1 - 1 - y) + 1;
    const std::vector<float>& s = sums_[channel];
    return (s[bottom * side + right] - s[top * side + right]) - (s[bottom * side + left] - s[top * side + left]);
}

void Convolver::join(std::size_t channel, int x0, int y, std::span<const float> light, const float* gained, float* out) const {
    const bool inner_row = y - picture_.y0 >= radius_ && picture_.y1 - 1 - y >= radius_;
    for (std::size_t i = 0; i < light.size(); ++i) {
        const int x = x0 + static_cast<int>(i);
        const bool inner = inner_row && x - picture_.x0 >= radius_ && picture_.x1 - 1 - x >= radius_;
        const float away = inner ? all_[channel] : given_away(channel, x, y);
        out[i] = light[i] == usable(light[i]) ? light[i] * (1 - away) + gained[i] : light[i];
    }
}

}  // namespace latent::image
