// base/simd_dispatch.h: functions that Highway compiles for several instruction sets, and the choice of one when they are called.
//
// Highway has a choice of its own, but in a library that measures the processor's clock whenever a program starts: a third of the
// time that our tools took to start.
#pragma once

#include <hwy/highway.h>

#include <cstdint>

namespace latent {

// Highway's targets (HWY_AVX2, ...) that this processor has, the fastest in the lowest bit.
std::int64_t simd_targets();
// From now on, functions are chosen from these; at first, they are all of simd_targets(). Not thread-safe.
void use_simd_targets(std::int64_t targets);

const hwy::ChosenTarget& chosen_simd_target();

}  // namespace latent

// After the versions of `function`, at the same namespace: LATENT_SIMD_EXPORT(function); a call is LATENT_SIMD_CALL(function)(...).
#define LATENT_SIMD_EXPORT(function)                                                                           \
    static decltype(&HWY_STATIC_DISPATCH(function)) const function##_versions[HWY_MAX_DYNAMIC_TARGETS + 2] = { \
        nullptr, HWY_CHOOSE_TARGET_LIST(function), HWY_CHOOSE_FALLBACK(function)}
#define LATENT_SIMD_CALL(function) (*function##_versions[latent::chosen_simd_target().GetIndex()])
