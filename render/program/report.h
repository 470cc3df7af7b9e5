// render/program/report.h: the final report of latent-render, as text or JSON, and the provenance in the file's header.
#pragma once

#include <string>

#include "render/program/forecast.h"
#include "render/program/loop.h"

namespace latent::render {

std::string to_text(const RenderReport& report, const RenderJob& job, bool json);
std::string to_text(const Forecast& forecast, const RenderJob& job, bool json);
std::string to_text(const RadianceFaults& faults);

// Program and version, scene, all settings that shape the samples or choose them, host and date, as JSON for the file's header.
// `committed_before`: samples of the part that earlier attempts have committed.
std::string provenance(const RenderJob& job, const RenderSettings& settings, std::uint64_t committed_before = 0);

}  // namespace latent::render
