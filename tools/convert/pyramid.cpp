#include "tools/convert/pyramid.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace latent::convert {

void halve(const float* row, const float* below, std::size_t width, float* out) {
    const auto shown = [](float light) { return std::min(std::max(light, 0.0f), 1.0f); };
    const std::size_t pairs = width / 2;
    if (below == nullptr) below = row;  // the mean of a row with itself is the row, exactly
    for (std::size_t i = 0; i < pairs; ++i) {
        out[i] = 0.25f * ((shown(row[2 * i]) + shown(row[2 * i + 1])) + (shown(below[2 * i]) + shown(below[2 * i + 1])));
    }
    if (width % 2 == 1) out[pairs] = 0.5f * (shown(row[width - 1]) + shown(below[width - 1]));
}

Pyramid::Pyramid(int height, std::size_t levels) : levels_(levels) {
    for (std::size_t i = 1; i < levels; ++i) {
        levels_[i].height = height;
        height = (height + 1) / 2;
    }
}

Status Pyramid::add(PlanarRows rows, const Emit& emit) {
    for (std::size_t n = 1; n < levels_.size(); ++n) {
        Level& level = levels_[n];
        if (Status s = emit(n, level.done, rows); !s) return s;
        level.done += rows.height;
        if (n + 1 == levels_.size()) break;
        if (level.kept.height > 0) {  // the waiting row goes in front
            level.kept.values.insert(level.kept.values.end(), rows.values.begin(), rows.values.end());
            level.kept.height += rows.height;
            std::swap(rows, level.kept);
            level.kept = {};
        }
        const bool complete = level.done == level.height;
        const int next_height = complete ? (rows.height + 1) / 2 : rows.height / 2;
        PlanarRows next((rows.width + 1) / 2, next_height);
        tbb::parallel_for(0, next_height, [&](int y) {
            for (std::size_t c = 0; c < 3; ++c) {
                const float* below = 2 * y + 1 < rows.height ? rows.plane(2 * y + 1, c) : nullptr;
                halve(rows.plane(2 * y, c), below, static_cast<std::size_t>(rows.width), next.plane(y, c));
            }
        });
        if (rows.height % 2 == 1 && !complete) {
            level.kept = PlanarRows(rows.width, 1);
            std::copy_n(rows.plane(rows.height - 1, 0), level.kept.values.size(), level.kept.values.begin());
        }
        if (next_height == 0) break;
        rows = std::move(next);
    }
    return {};
}

}  // namespace latent::convert
