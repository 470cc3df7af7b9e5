// render/load/mesh/ply.h: meshes of triangles and quads from PLY files, ascii or binary of either byte order [Turk94].
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "render/math/vec.h"

namespace latent::render {

struct PlyMesh {
    std::vector<Vec3d> positions;              // x y z
    std::vector<Vec3f> normals;                // nx ny nz, or empty; 0 where it is not finite
    std::uint64_t lost_normals = 0;            // how many these are
    std::vector<std::array<float, 4>> colors;  // linear: red green blue and alpha, or empty; integers are encoded as sRGB
    std::vector<Vec2f> uvs;                    // u v, s t, texture_u texture_v or texture_s texture_t, or empty
    std::vector<std::uint32_t> triangles;      // 3 indices each
    std::vector<std::uint32_t> quads;          // 4 indices each, around the quad
};

// Other elements and properties are skipped. Errors: kForeign (no PLY header), kTruncated, kCorrupt (an index out of range, a
// position that is not finite), kUnsupported (a face with more than 4 sides). Each begins with `name` and, in text, the line.
Result<PlyMesh> parse_ply(std::string_view bytes, std::string_view name);

}  // namespace latent::render
