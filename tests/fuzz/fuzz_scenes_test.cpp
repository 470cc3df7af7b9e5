// The targets that read scenes, tables and options.
#include "tests/fuzz/target.h"

namespace latent::fuzz {

std::vector<Target> all_targets() { return {pbrt(), gltf(), obj(), ply(), csv(), expressions()}; }

}  // namespace latent::fuzz
