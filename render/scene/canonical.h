// render/scene/canonical.h: one description for all layouts of a scene.
#pragma once

#include "base/hash.h"
#include "render/scene/description.h"

namespace latent::render {

// Entries of the tables (materials, media ...) that nothing uses go, equal ones become one, and the rest comes in the order of its
// first use; -0 is 0. Scenes with equal content hashes are equal after this, but for labels, so that all that is built of them is
// equal too. Returns the content hash, which stays as it was.
Hash128 make_canonical(SceneDescription& scene);

}  // namespace latent::render
