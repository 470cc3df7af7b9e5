// render/load/gltf/schema.h: the members of a glTF document: their names, what they hold, and which must be there [glTF2 5].
#pragma once

#include <span>
#include <string_view>

#include "render/load/gltf/value.h"

namespace latent::render {

struct GltfObjectType;

struct GltfMember {
    enum class Holds : std::uint8_t {
        kAnything,  // which is not read
        kText,
        kFlag,
        kNumber,
        kCount,    // a non-negative integer, such as an index
        kNumbers,  // an array of `size` numbers
        kCounts,   // an array of indices
        kTexts,
        kObject,   // of `type`
        kObjects,  // an array of them
    };
    std::string_view name;
    Holds holds = Holds::kAnything;
    bool required = false;
    std::uint32_t size = 0;
    const GltfObjectType* type = nullptr;
};

struct GltfObjectType {
    std::span<const GltfMember> members;
    bool is_open = false;  // other members are no surprise: extensions that are not supported
};

// The whole document: an error for each member that holds something else than it should, or is missing; a warning for each kind of
// member that nobody knows, with near names. What is not read is not checked: "extras", animations, skins, unknown extensions.
// Returns false after an error: what follows from it would be told as another one.
bool check_gltf(const GltfValue& root);

}  // namespace latent::render
