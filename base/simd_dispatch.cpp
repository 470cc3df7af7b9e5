#include "base/simd_dispatch.h"

#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace latent {

namespace {

struct Chosen {
    hwy::ChosenTarget target;
    Chosen() { target.Update(simd_targets()); }
};

hwy::ChosenTarget& chosen() {
    static Chosen chosen;
    return chosen.target;
}

}  // namespace

std::int64_t simd_targets() {
#if defined(__x86_64__)
    std::int64_t targets = HWY_SSE4;  // what all is compiled for
    unsigned a = 0, b = 0, c = 0, d = 0;
    const bool f16c = __get_cpuid(1, &a, &b, &c, &d) != 0 && (c & bit_F16C) != 0;
    const bool lzcnt = __get_cpuid(0x80000001, &a, &b, &c, &d) != 0 && (c & bit_LZCNT) != 0;
    const bool avx2 = f16c && lzcnt && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                      __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");  // and the system saves the registers
    if (avx2) targets |= HWY_AVX2;
    if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512bw"))
        targets |= HWY_AVX3;
    return targets;
#else
    return HWY_TARGETS;
#endif
}

void use_simd_targets(std::int64_t targets) { chosen().Update(targets); }

const hwy::ChosenTarget& chosen_simd_target() { return chosen(); }

}  // namespace latent
