#include "python/tools.h"

#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <optional>
#include <utility>

#include "base/memory.h"
#include "c_api/latent.h"
#include "python/arrays.h"
#include "python/failure.h"
#include "tools/develop/picture/picture.h"
#include "tools/develop/picture/pixel_array.h"
#include "tools/develop/picture/report.h"

namespace py = pybind11;

namespace latent::python {

namespace {

// What a tool's own parser makes of `text`.
template <class Parse>
auto parsed(const Parse& parse, const std::string& text) {
    auto value = parse(text);
    if (!value) throw Failure(value.error().message);
    return *value;
}

std::optional<sampledb::SampleRange> samples_of(const py::dict& options, const char* name) {
    const auto range = get<std::optional<Range>>(options, name);
    if (!range) return std::nullopt;
    return sampledb::SampleRange{range->first, range->second};
}

std::optional<sampledb::JobId> job_of(const py::dict& options) {
    const auto job = get<std::optional<JobHalves>>(options, "job");
    if (!job) return std::nullopt;
    return sampledb::JobId{job->second, job->first};
}

develop::PictureOptions picture_options(const std::vector<std::string>& paths, const py::dict& given) {
    develop::PictureOptions options;
    options.inputs.assign(paths.begin(), paths.end());
    options.size = get<std::string>(given, "size");
    if (const auto crop = get<std::optional<std::array<std::int64_t, 4>>>(given, "crop"))
        options.crop = develop::PixelRect{(*crop)[0], (*crop)[1], (*crop)[2], (*crop)[3]};
    if (const auto filter = get<std::string>(given, "filter"); !filter.empty()) options.filter = filter;
    options.observer.name = get<std::string>(given, "observer");
    options.observer.camera_xyz = get<bool>(given, "camera_xyz");
    options.observer.balanced = get<bool>(given, "raw_balance");
    options.observer.lens_filter = get<std::string>(given, "lens_filter");
    options.observer.filter_factor = get<double>(given, "filter_factor");
    options.lights = get<std::vector<std::string>>(given, "lights");
    if (const auto aperture = get<std::string>(given, "aperture"); !aperture.empty())
        options.lens.aperture = parsed(develop::parse_aperture, aperture);
    if (const auto shutter = get<std::string>(given, "shutter"); !shutter.empty())
        options.lens.shutter = parsed(develop::parse_shutter, shutter);
    if (const auto focus = get<std::string>(given, "focus"); !focus.empty()) options.focus = parsed(develop::parse_focus, focus);
    options.lens.exposure_follows = get<bool>(given, "exposure_follows");
    options.image = get<std::string>(given, "image");
    options.dim_fireflies = get<bool>(given, "dim_fireflies");
    options.denoise = get<double>(given, "denoise");
    options.ratio = get<bool>(given, "ratio");
    if (const auto bins = get<std::string>(given, "spectral_bins"); !bins.empty())
        options.spectral_bins = parsed(develop::parse_spectral_bins, bins);
    if (const auto layers = get<std::string>(given, "layers"); !layers.empty())
        options.layers = parsed(develop::parse_layers, layers);
    options.layers.halves = get<bool>(given, "halves");
    options.samples = samples_of(given, "samples");
    options.job = job_of(given);
    options.skip_duplicates = get<bool>(given, "skip_duplicates");
    const auto memory = get<std::uint64_t>(given, "memory");
    options.memory = memory != 0 ? memory : default_memory();
    options.threads = get<int>(given, "threads");
    return options;
}

}  // namespace

py::dict merge(const std::vector<std::string>& paths, const std::string& output, const py::dict& options) {
    std::vector<const char*> names;
    names.reserve(paths.size());
    for (const std::string& path : paths) names.push_back(path.c_str());
    std::vector<std::string> left_out;
    latent_merge_options given{};
    given.size = sizeof given;
    given.verify = get<std::uint32_t>(options, "verify");
    given.replace = get<bool>(options, "replace") ? 1 : 0;
    given.skip_duplicates = get<bool>(options, "skip_duplicates") ? 1 : 0;
    given.keep_going = get<bool>(options, "keep_going") ? 1 : 0;
    given.compact = get<bool>(options, "compact") ? 1 : 0;
    given.threads = get<std::uint32_t>(options, "threads");
    given.memory = get<std::uint64_t>(options, "memory");
    if (const auto require = samples_of(options, "require")) given.require = {require->first, require->end};
    if (const auto job = job_of(options)) given.job_low = job->low, given.job_high = job->high;
    given.left_out = [](void* list, const char* item) { static_cast<std::vector<std::string>*>(list)->emplace_back(item); };
    given.context = &left_out;
    latent_merge_info info{};
    info.size = sizeof info;
    latent_error error;
    latent_status status;
    {
        const py::gil_scoped_release release;
        status = latent_merge(names.data(), names.size(), output.c_str(), &given, &info, &error);
    }
    check(status, error);
    py::dict d;
    d["samples"] = info.samples, d["files"] = info.files, d["runs_in"] = info.runs_in, d["runs_out"] = info.runs_out;
    d["camera_records"] = info.camera_records, d["light_records"] = info.light_records, d["bytes"] = info.bytes;
    d["left_out"] = left_out;
    return d;
}

py::tuple develop(const std::vector<std::string>& paths, const py::dict& given) {
    const develop::PictureOptions options = picture_options(paths, given);
    const auto picture = std::make_shared<develop::PixelArray>();
    Result<develop::PictureReport> report = Error{};
    {
        const py::gil_scoped_release release;
        try {
            report = develop::develop_picture(options, *picture, {});
        } catch (...) {
            report = current_error();  // out of memory, above all
        }
    }
    if (!report) throw Failure(report.error().message);
    // The array keeps the picture alive.
    const auto owner = py::capsule(new std::shared_ptr<develop::PixelArray>(picture),
                                   [](void* held) { delete static_cast<std::shared_ptr<develop::PixelArray>*>(held); });
    const std::vector<std::size_t> shape = {picture->height(), picture->width(), picture->channels().size()};
    const py::array_t<float> pixels(shape, picture->pixels().data(), owner);
    std::vector<std::string> warnings = develop::losses(*report);
    warnings.insert(warnings.end(), report->warnings.begin(), report->warnings.end());
    for (std::string& line : warnings) line = in_words_of_python(line);
    return py::make_tuple(pixels, picture->channels(), warnings);
}

}  // namespace latent::python
