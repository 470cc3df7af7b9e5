// tools/inspect/noise.h: how noisy a picture of these files is, what it takes to make it less so, and where it is noisiest.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "base/progress.h"
#include "base/result.h"
#include "tools/develop/noise/noise.h"

namespace latent::inspect {

struct NoiseOptions {
    develop::PictureOptions picture;
    std::filesystem::path map;  // .png or .exr; "": none
    bool force = false;
};

struct NoiseReport {
    develop::Noise noise;
    std::optional<double> cpu_seconds_per_sample;  // if all files say it
    double bytes_per_sample = 0;
    std::filesystem::path map;

    // The area of the picture that has the largest relative standard error; none without light.
    std::optional<develop::PixelRect> noisiest() const;
};

// Errors: of measure_noise, of reading the files and writing the map.
Result<NoiseReport> look_for_noise(const NoiseOptions& options, const Progress& progress);

std::string to_text(const NoiseReport& report);
nlohmann::json to_json(const NoiseReport& report);

}  // namespace latent::inspect
