// image/rect.h: rectangles of pixels.
#pragma once

#include <algorithm>
#include <cstddef>

namespace latent::image {

// Half open: x0 <= x < x1, y0 <= y < y1; y grows downwards.
struct Rect {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    bool empty() const { return x1 <= x0 || y1 <= y0; }
    std::size_t pixels() const { return empty() ? 0 : static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()); }
    bool contains(const Rect& other) const { return x0 <= other.x0 && y0 <= other.y0 && other.x1 <= x1 && other.y1 <= y1; }
    bool operator==(const Rect&) const = default;
};

inline Rect intersect(const Rect& a, const Rect& b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

}  // namespace latent::image
