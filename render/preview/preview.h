// render/preview/preview.h: a first look at a job: a few seconds of it, developed and printed.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

#include "base/result.h"
#include "render/program/forecast.h"

namespace latent::render {

struct Preview {
    std::filesystem::path picture;
    int width = 0, height = 0;
    double sensitivity = 1;  // that it was printed with
    bool is_black = false;   // no exposure could be chosen
    bool is_denoised = false;
    Forecast forecast;  // for the whole job
};

// NAME.preview.png, beside the output NAME.latent.
std::filesystem::path preview_path(const RenderOptions& options);

// Renders for `seconds` into a temporary file beside the output, develops it, without its noise if `denoise`, and writes it to
// preview_path, in the place of what is there. The picture is no larger than the job's resolution, than 1024 pixels, and than what
// has enough samples for each pixel. Errors: those of render, develop and convert; kStopped if not one sample was finished.
Result<Preview> preview(const RenderJob& job, const RenderOptions& options, double seconds, bool denoise,
                        const std::atomic<bool>& stop);

std::string to_text(const Preview& preview, const RenderJob& job, bool json);

}  // namespace latent::render
