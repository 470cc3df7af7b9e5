// render/load/brdf/measured.h: measured materials (.bsdf) of the RGL database [DupuyJakob18]. docs/scenes.md, "Measured materials".
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "base/result.h"
#include "render/scene/measured_brdf.h"

namespace latent::render {

// Nothing in the file is trusted: tables that lie outside of it or do not fit together, and values that are not finite, are
// refused. Negative values become 0. Errors: those of read_tensors.
Result<std::shared_ptr<const MeasuredBrdf>> read_measured_brdf(std::span<const std::byte> file);

}  // namespace latent::render
