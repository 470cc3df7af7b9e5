// The targets that read sample files and pictures, and what mends checksums for them.
#include <gtest/gtest.h>

#include "tests/fuzz/target.h"

namespace latent::fuzz {

std::vector<Target> all_targets() {
    return {header(), footer(), run(), page(), file(), part(), http(), arguments(), exr(), icc(), recipe()};
}

// Else, mutants would end at the first checksum.
TEST(FuzzMend, AFileThatWasMendedReadsAsBefore) {
    for (const Target& target : all_targets()) {
        if (target.mend == nullptr) continue;
        for (Bytes seed : target.made_seeds()) {
            const Bytes before = seed;
            target.mend(seed);
            EXPECT_EQ(seed, before) << target.name;
        }
    }
}

}  // namespace latent::fuzz
