#include "python/failure.h"

#include "c_api/words.h"

namespace latent::python {

std::string in_words_of_python(const std::string& message) {
    static constexpr c::Word kArguments[] = {{"options.job_low and job_high", "job=..."},
                                             {"options.skip_duplicates", "skip_duplicates=True"},
                                             {"options.replace", "replace=True"},
                                             {"options.memory", "memory"},
                                             {"options.checkpoint_seconds", "checkpoint_seconds"},
                                             {"options.provenance", "provenance"},
                                             {"options.compact", "compact=True"},
                                             {"latent-merge --compact", "latent.merge(..., compact=True)"},
                                             {"--camera-output xyz", "camera_xyz=True"},
                                             {"--camera-output raw", "camera_xyz=False"},
                                             {"--aperture", "aperture"},
                                             {"--crop", "crop"},
                                             {"--estimator", "estimator"},
                                             {"--filter", "filter"},
                                             {"--filter-factor", "filter_factor"},
                                             {"--focus", "focus"},
                                             {"--halves", "halves=True"},
                                             {"--image", "image"},
                                             {"--job", "job=..."},
                                             {"--layers", "layers"},
                                             {"--lens-filter", "lens_filter"},
                                             {"--light", "lights"},
                                             {"--list-observers", "latent-develop --list-observers"},
                                             {"--memory", "memory"},
                                             {"--observer", "observer"},
                                             {"--raw-balance none", "raw_balance=False"},
                                             {"--samples", "samples"},
                                             {"--shutter", "shutter"},
                                             {"--size", "size"},
                                             {"--skip-duplicates", "skip_duplicates=True"},
                                             {"--spectral-bins", "spectral_bins"},
                                             {"--threads", "threads"}};
    return c::reworded(message, kArguments);
}

}  // namespace latent::python
