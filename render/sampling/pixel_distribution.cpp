#include "render/sampling/pixel_distribution.h"

#include <algorithm>
#include <numeric>

namespace latent::render {

PixelDistribution::PixelDistribution(std::vector<double> weight, std::uint32_t width, double mean) {
    for (double& w : weight) w = 0.9 * w + 0.1 * std::max(mean, 1e-30);
    std::vector<double> rows;
    for (std::size_t begin = 0; begin < weight.size(); begin += width) {
        const auto row = std::span<const double>(weight).subspan(begin, width);
        rows.push_back(std::accumulate(row.begin(), row.end(), 0.0));
        columns_.emplace_back(row);
    }
    rows_ = PiecewiseConstant(rows);
}

PixelDistribution::Pixel PixelDistribution::sample(Uniform u, Uniform v) const {
    Pixel out;
    out.y = rows_.sample(v, out.in_y);
    out.x = columns_[out.y].sample(u, out.in_x);
    return out;
}

}  // namespace latent::render
