// render/scene/among_vertices.h: a point of a mesh by the vertices about it, for what vertices carry.
#pragma once

#include <array>
#include <cstdint>

#include "render/scene/description.h"

namespace latent::render {

// A value given per vertex is sum_i weight[i] x value(vertex[i]) at the point, and its derivatives along u and v are the same sums
// with du and dv.
struct AmongVertices {
    const MeshDescription* mesh = nullptr;  // null: the shape has no vertices, or they carry neither colours nor further uvs
    std::array<std::uint32_t, 4> vertex{};
    std::array<float, 4> weight{}, du{}, dv{};  // the fourth is 0 on a triangle

    // The point that lies u and v further along the surface, as far as it is flat.
    AmongVertices moved(float u, float v) const {
        AmongVertices out = *this;
        for (std::size_t i = 0; i < 4; ++i) out.weight[i] += du[i] * u + dv[i] * v;
        return out;
    }
    Vec2f sum(const std::vector<Vec2f>& values, const std::array<float, 4>& weights) const {
        Vec2f out;
        for (std::size_t i = 0; i < 4; ++i) {
            out.x += weights[i] * values[vertex[i]].x;
            out.y += weights[i] * values[vertex[i]].y;
        }
        return out;
    }
    // White where the mesh has none.
    std::array<float, 4> color() const {
        if (mesh == nullptr || mesh->colors.empty()) return {1, 1, 1, 1};
        std::array<float, 4> out{};
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t c = 0; c < 4; ++c) out[c] += weight[i] * mesh->colors[vertex[i]][c];
        }
        return out;
    }
};

}  // namespace latent::render
