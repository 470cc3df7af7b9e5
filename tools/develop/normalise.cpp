#include "tools/develop/normalise.h"

namespace latent::develop {

namespace {

template <bool kCamera, bool kLight>
std::size_t normalise(const SumRow& row, int stride, int channels, float* out) {
    std::size_t few = 0;
    const double* camera = row.camera;
    const double* light = row.light;
    for (std::size_t i = 0; i < row.least_weight.size(); ++i, out += channels) {
        double per_weight = 0;
        if constexpr (kCamera) {
            const double weight = camera[channels];
            const bool enough = weight > 0 && weight >= row.least_weight[i];
            per_weight = enough ? 1 / weight : 0;
            few += enough ? 0 : 1;
        }
        for (int c = 0; c < channels; ++c) {
            double sum = 0;
            if constexpr (kCamera) sum = camera[c] * per_weight;
            if constexpr (kLight) sum += light[c] * row.light_scale[i];
            out[c] = static_cast<float>(sum);
        }
        if constexpr (kCamera) camera += stride;
        if constexpr (kLight) light += stride;
    }
    return few;
}

template <bool kCamera, bool kLight>
std::size_t normalise_any(const SumRow& row, int channels, float* out) {
    if (channels == 3) return normalise<kCamera, kLight>(row, 4, 3, out);  // the loop over channels unrolled
    return normalise<kCamera, kLight>(row, row.stride, channels, out);
}

}  // namespace

std::size_t normalise_row(const SumRow& row, int channels, float* out) {
    if (row.camera && row.light) return normalise_any<true, true>(row, channels, out);
    if (row.camera) return normalise_any<true, false>(row, channels, out);
    if (row.light) return normalise_any<false, true>(row, channels, out);
    return normalise_any<false, false>(row, channels, out);
}

}  // namespace latent::develop
