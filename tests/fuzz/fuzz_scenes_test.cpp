// The targets that read scenes and their files, tables and options.
#include "tests/fuzz/target.h"

namespace latent::fuzz {

std::vector<Target> all_targets() {
    return {pbrt(), gltf(), obj(), ply(), nanovdb(), picture(), spectrum(), measured(), csv(), expressions()};
}

}  // namespace latent::fuzz
