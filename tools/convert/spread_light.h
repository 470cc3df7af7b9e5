// tools/convert/spread_light.h: a picture whose light spreads, made tile by tile while it is printed. Equations: docs/color.md,
// "Light that spreads".
#pragma once

#include <optional>

#include "image/convolver.h"
#include "tools/convert/rows.h"

namespace latent::convert {

// Where light goes. What goes far does so from and to squares of `cell` pixels, which are small beside its way: convolutions of
// large pictures take little memory and time then.
struct Spread {
    std::optional<image::Kernel> near;  // applied to pixels, before the other
    std::optional<image::Kernel> far;   // applied to cells
    int cell = 1;

    explicit operator bool() const { return near || far; }
};

// Bytes of memory that light_rows() holds, and 44 MiB for the program and for making kernels.
std::size_t spread_bytes(const Spread& spread, const image::ExrImage& image, int threads);

// Rows of the pixels of `source`, which must outlive the result. `print`: the bands that will be made and read, in their order. The
// files are in `folder`. Errors: kIo.
Result<std::unique_ptr<Rows>> light_rows(const Source& source, Spread spread, const BandPlan& print,
                                         const std::filesystem::path& folder, int threads);

}  // namespace latent::convert
