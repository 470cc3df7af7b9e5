// render/load/gltf/meshopt.h: what a buffer view holds in the compression of meshoptimizer
// [glTF2 KHR_meshopt_compression, EXT_meshopt_compression], versions 0 and 1.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/result.h"

namespace latent::render {

// As the extension describes a view: `count` items of `stride` bytes each.
struct MeshoptView {
    std::string mode{}, filter = "NONE";
    std::uint64_t count = 0, stride = 0;
};

// The count * stride bytes that `packed` holds. Needs no more room than 1024 times that of `packed`. Errors: kUnsupported: no such
// mode or filter, or they do not go together; kTruncated, kCorrupt.
Result<std::string> unpack_meshopt(std::string_view packed, const MeshoptView& view);

}  // namespace latent::render
