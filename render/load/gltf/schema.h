// render/load/gltf/schema.h: the members of a glTF document: their names, what they hold, and which must be there [glTF2 5].
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace latent::render {

struct GltfObjectType;

struct GltfMember {
    enum class Holds : std::uint8_t {
        kAnything,  // not checked
        kUnread,    // not checked, and not used: the kind is `kind`
        kText,
        kFlag,
        kNumber,
        kCount,    // a non-negative integer, such as an index
        kNumbers,  // an array of `size` numbers
        kCounts,   // an array of indices
        kTexts,
        kObject,   // with the members of `type`
        kObjects,  // an array of them
    };
    std::string_view name;
    Holds holds = Holds::kAnything;
    bool required = false;
    std::uint32_t size = 0;
    const GltfObjectType* type = nullptr;
    std::string_view kind{};  // in files/unread.h
};

struct GltfObjectType {
    std::span<const GltfMember> members;
    bool is_open = false;  // other members are no surprise: extensions that are not supported
};

const GltfObjectType& gltf_document();

}  // namespace latent::render
