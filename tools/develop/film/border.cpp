#include "tools/develop/film/border.h"

#include <array>
#include <cmath>
#include <cstdlib>

namespace latent::develop {

namespace {

constexpr int kPieces = 64;  // per side of a pixel square; on each piece three Gauss-Legendre nodes
constexpr int kNodes = 3 * kPieces;

struct Node {
    double at, weight;
};
std::array<Node, kNodes> nodes_over_one_pixel() {
    const double offset = std::sqrt(3.0 / 5.0) / 2;
    std::array<Node, kNodes> nodes;
    for (int i = 0; i < kPieces; ++i) {
        nodes[3 * i] = {(i + 0.5 - offset) / kPieces - 0.5, 5.0 / 18 / kPieces};
        nodes[3 * i + 1] = {(i + 0.5) / kPieces - 0.5, 8.0 / 18 / kPieces};
        nodes[3 * i + 2] = {(i + 0.5 + offset) / kPieces - 0.5, 5.0 / 18 / kPieces};
    }
    return nodes;
}

}  // namespace

BorderShare::BorderShare(const Filter& filter, std::uint32_t width, std::uint32_t height)
    : reach_(filter.reach()), width_(width), height_(height) {
    const int side = 2 * reach_ + 1;
    light_squares_.assign(side * side, 0.0);
    camera_squares_.assign(side * side, 0.0);
    const std::array<Node, kNodes> nodes = nodes_over_one_pixel();
    // A record at (s, t) from the centre of its own pixel lies (x + s, y + t) from that of the pixel at offset (-x, -y). Filters
    // are even in both directions, so s, t >= 0 is enough: the other three quarters mirror the squares.
    std::vector<double> weights(side * side);
    std::vector<double> light(side * side), camera(side * side);
    for (const Node& v : nodes) {
        if (v.at < 0) continue;
        for (const Node& u : nodes) {
            if (u.at < 0) continue;
            double lattice = 0;
            for (int i = 0; i < side * side; ++i) {
                weights[i] = filter.weight(i % side - reach_ + u.at, i / side - reach_ + v.at);
                lattice += weights[i];
            }
            const double area = u.weight * v.weight;
            for (int i = 0; i < side * side; ++i) {
                light[i] += area * (weights[i] / lattice);
                camera[i] += area * weights[i];
            }
        }
    }
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const int mirror_x = side - 1 - x, mirror_y = side - 1 - y;
            const auto all_quarters = [&](const std::vector<double>& s) {
                return (s[y * side + x] + s[mirror_y * side + mirror_x]) + (s[mirror_y * side + x] + s[y * side + mirror_x]);
            };
            light_squares_[y * side + x] = all_quarters(light);
            camera_squares_[y * side + x] = all_quarters(camera);
        }
    }
    integral_ = 0;
    for (const double share : camera_squares_) integral_ += share;
}

bool BorderShare::inside(const PixelRect& pixels) const {
    return pixels.x0 >= reach_ && pixels.y0 >= reach_ && pixels.x1 + reach_ <= width_ && pixels.y1 + reach_ <= height_;
}

double BorderShare::sum_on_film(const std::vector<double>& squares, std::uint32_t x, std::uint32_t y) const {
    double sum = 0;
    for (int dy = -reach_; dy <= reach_; ++dy) {
        for (int dx = -reach_; dx <= reach_; ++dx) {
            const std::int64_t px = std::int64_t{x} + dx, py = std::int64_t{y} + dy;
            if (px < 0 || py < 0 || px >= width_ || py >= height_) continue;
            sum += squares[(dy + reach_) * (2 * reach_ + 1) + dx + reach_];
        }
    }
    return sum;
}

double BorderShare::light_share(std::uint32_t x, std::uint32_t y) const {
    return inside({x, y, std::int64_t{x} + 1, std::int64_t{y} + 1}) ? 1.0 : sum_on_film(light_squares_, x, y);
}

double BorderShare::camera_share(std::uint32_t x, std::uint32_t y) const {
    return inside({x, y, std::int64_t{x} + 1, std::int64_t{y} + 1}) ? integral_ : sum_on_film(camera_squares_, x, y);
}

}  // namespace latent::develop
