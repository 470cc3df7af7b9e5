// tests/color/simd_targets.h: runs a piece of code once with every instruction set that this build and processor have.
#pragma once

#include <gtest/gtest.h>

#include "base/simd_dispatch.h"

namespace latent::color {

template <class Function>
void with_every_simd_target(const Function& function) {
    int tried = 0;
    for (std::int64_t rest = simd_targets() & HWY_TARGETS; rest != 0; rest &= rest - 1) {
        const std::int64_t target = rest & -rest;
        SCOPED_TRACE(hwy::TargetName(target));
        use_simd_targets(target);
        function();
        ++tried;
    }
    use_simd_targets(simd_targets());
    EXPECT_GE(tried, 1);
}

}  // namespace latent::color
