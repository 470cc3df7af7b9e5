// render/scene/content_hash.h: the identity of a scene, whichever format and layout it came from. docs/jobs.md, "What is in the
// job id?".
#pragma once

#include <unordered_map>

#include "base/hash.h"
#include "render/scene/description.h"

namespace latent::render {

// By content: numbers bit for bit (-0 is 0, but for those in long lists), an index by the content of what it refers to. So
// definitions that nothing uses do not count, nor does the order in which tables hold the others, nor whether two references lead
// to one entry or to two equal ones.
struct ContentHashes {
    Hash128 scene;
    std::unordered_map<const void*, Hash128> entries{};  // hashes of the tables' entries that are used, by address
};
ContentHashes content_hashes(const SceneDescription& scene);

inline Hash128 content_hash(const SceneDescription& scene) { return content_hashes(scene).scene; }

}  // namespace latent::render
