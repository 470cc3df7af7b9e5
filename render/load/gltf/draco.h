// render/load/gltf/draco.h: a mesh in the compression of Draco [glTF2 KHR_draco_mesh_compression].
#pragma once

#include <cstdint>
#include <map>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace latent::render {

struct DracoMesh {
    struct Attribute {
        std::size_t components = 0;
        std::vector<float> values{};  // vertex after vertex; integers as they are
        float largest = 1;            // the end of the range of its integers
    };
    std::size_t vertices = 0;
    std::vector<std::uint32_t> indices{};             // three per triangle
    std::map<std::uint32_t, Attribute> attributes{};  // by the ids that the file gives them
};

// Errors: kUnsupported: not version 2.2, or of points or with metadata; kTruncated, kCorrupt.
Result<DracoMesh> unpack_draco(std::string_view packed);

}  // namespace latent::render
