// tools/develop/engine/develop.h: from records to pixels in bounded memory, each page decoded once. docs/developing.md.
#pragma once

#include <cstdint>
#include <filesystem>

#include "base/progress.h"
#include "base/result.h"
#include "sampledb/read/run_set.h"
#include "tools/develop/channels/channels.h"
#include "tools/develop/engine/assembly.h"
#include "tools/develop/engine/fireflies.h"
#include "tools/develop/film/film_grid.h"
#include "tools/develop/film/filter.h"

namespace latent::develop {

struct Settings {
    std::uint32_t width = 0, height = 0;  // the whole film's
    PixelRect crop;                       // the part of it that is wanted
    Filter filter = Filter::standard();
    bool camera = true, light = true;               // which images are added up
    bool dim_fireflies = false;                     // the channels have Layers::samples then
    std::uint64_t memory = std::uint64_t{1} << 30;  // bytes to stay within, apart from the index of the files
    std::uint64_t list_memory = 0;                  // what that takes however much memory there is
    std::filesystem::path temporary_folder = ".";   // for unnamed files
    Stopped stopped;
};

struct DevelopCounts {
    std::uint64_t camera_records = 0, light_records = 0;  // developed: of the selected samples, those that may reach into the crop
    std::uint64_t light_paths = 0;                        // N
    std::uint64_t regions = 0, batches = 0, panes = 0;
    std::uint64_t pages = 0, pages_decoded = 0;  // pages that the crop needs; decoded, repeats included
    std::uint64_t page_bytes = 0, page_bytes_decoded = 0;
    std::uint64_t segments = 0;  // records of one page in one cell
    std::uint64_t camera_not_finite = 0, light_not_finite = 0;
    std::uint64_t fallback_pixels = 0, empty_pixels = 0;
    DimmedLight camera_dimmed, light_dimmed;  // fireflies
    std::uint64_t temporary_bytes = 0;
    double decode_factor() const {
        return page_bytes == 0 ? 1.0 : static_cast<double>(page_bytes_decoded) / static_cast<double>(page_bytes);
    }
};

inline constexpr std::uint32_t kMaxSide = std::uint32_t{1} << 23;  // pixels

// Runs on the threads of the arena that it is called in. Errors: of reading, of `sink`, kOutOfRange (memory too small for one
// cell), kStopped.
Result<DevelopCounts> develop(const sampledb::RunSet& run_set, const Channels& channels, const Settings& settings, TileSink& sink,
                              const Progress& progress = {});

// Bytes of pages, on disk, that would be decoded: more than there are if Settings::memory is too small to decode each once. And
// about how many segments they would make, and what these take in memory beside their records. Errors: of reading.
struct PlannedWork {
    double bytes = 0, segments = 0, segment_bytes = 0;
};
Result<PlannedWork> planned_work(const sampledb::RunSet& run_set, const Channels& channels, const Settings& settings);

}  // namespace latent::develop
