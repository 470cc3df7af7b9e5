#include "tools/develop/picture/report.h"

#include <fmt/format.h>

#include "base/json.h"
#include "base/size.h"
#include "sampledb/read/report_json.h"

namespace latent::develop {

namespace {

nlohmann::json json_of(const color::CameraFit& fit) {
    return {{"xyz_from_rgb", fit.xyz_from_rgb.m},
            {"mean_ciede2000", fit.mean_difference},
            {"largest_ciede2000", fit.largest_difference}};
}

nlohmann::json json_of(const DimmedLight& dimmed) { return {{"samples", dimmed.samples}, {"share_of_light", dimmed.share()}}; }

}  // namespace

std::string to_json(const PictureReport& r) {
    const DevelopCounts& c = r.counts;
    nlohmann::json report = {{"output", r.output},
                             {"width", r.width},
                             {"height", r.height},
                             {"samples_per_pixel", r.samples_per_pixel()},
                             {"crop", {r.crop.x0, r.crop.y0, r.crop.x1, r.crop.y1}},
                             {"filter", r.filter},
                             {"observer", r.observer.empty() ? nlohmann::json() : nlohmann::json(r.observer)},
                             {"filter_factor", r.filter_factor},
                             {"lights", r.lights},
                             {"job", to_hex(r.job)},
                             {"files", r.files},
                             {"available_samples", r.available},
                             {"runs", r.runs},
                             {"light_paths", c.light_paths},
                             {"camera_records", c.camera_records},
                             {"light_records", c.light_records},
                             {"bytes_stored", r.bytes_stored},
                             {"bytes_read", r.bytes_read},
                             {"pages", c.pages},
                             {"decode_factor", c.decode_factor()},
                             {"regions", c.regions},
                             {"temporary_bytes", c.temporary_bytes},
                             {"fallback_pixels", c.fallback_pixels},
                             {"empty_pixels", c.empty_pixels},
                             {"camera_not_finite", c.camera_not_finite},
                             {"light_not_finite", c.light_not_finite},
                             {"superseded_runs", r.run_set.superseded_runs},
                             {"repeated_runs", r.run_set.repeated_runs},
                             {"seconds", r.seconds},
                             {"left_out", r.run_set.left_out},
                             {"notes", r.run_set.notes},
                             {"warnings", r.warnings}};
    if (r.lens) {
        report["lens"] = {{"light", r.lens->light}, {"samples_kept", r.lens->samples}, {"noise", r.lens->noise()}};
        if (r.lens->focus && std::isfinite(*r.lens->focus)) report["lens"]["focus"] = *r.lens->focus;
        if (r.lens->focus && !std::isfinite(*r.lens->focus)) report["lens"]["focus"] = "infinity";
    }
    if (r.dims_fireflies) report["fireflies"] = {{"camera", json_of(c.camera_dimmed)}, {"light", json_of(c.light_dimmed)}};
    if (r.camera_fit) report["camera_fit"] = json_of(*r.camera_fit);
    return with_member(with_member(json_text(report), "samples", r.coverage), "missing_samples", r.missing) + "\n";
}

std::string to_text(const PictureReport& r) {
    const DevelopCounts& c = r.counts;
    std::string text =
        fmt::format("{}: {} x {} pixels of {} x {}, {}, {}; {} camera and {} light records, samples {}\n", r.output, r.crop.width(),
                    r.crop.height(), r.width, r.height, r.filter, r.observer.empty() ? "in spectral bins" : r.observer,
                    c.camera_records, c.light_records, to_string(r.coverage));
    text += fmt::format("{}{}\n", format_samples_per_pixel(r.samples_per_pixel()),
                        r.size_chosen ? "" : "; choose another size with --size WIDTH");
    text += fmt::format("read {} of {} in {}, {}, decode factor {:.2f}\n", format_size(r.bytes_read), format_size(r.bytes_stored),
                        format_duration(r.seconds), counted(c.regions, "region"), c.decode_factor());
    if (r.coverage.size() < r.available)
        text += fmt::format("a preview of {:.2g} % of the samples\n",
                            100 * static_cast<double>(r.coverage.size()) / static_cast<double>(r.available));
    if (r.lens && r.lens->focus)
        text += std::isfinite(*r.lens->focus) ? fmt::format("focused at a distance of {:.4g}\n", *r.lens->focus)
                                              : "focused at infinity\n";
    if (r.lens && (r.lens->light < 1 || r.lens->samples < 1))
        text += fmt::format(
            "lens and shutter: {:.3g} % of the light; noise as from {:.3g} % of the samples, {:.{}f} times that of all\n",
            100 * r.lens->light, 100 * r.lens->samples, r.lens->noise(), r.lens->noise() < 10 ? 1 : 0);
    if (r.dims_fireflies)
        text += fmt::format("fireflies: {} dimmed; the camera image lost {:.2g} % of its light, the light image {:.2g} %\n",
                            counted(c.camera_dimmed.samples + c.light_dimmed.samples, "sample"), 100 * c.camera_dimmed.share(),
                            100 * c.light_dimmed.share());
    if (r.filter_factor != 1) text += fmt::format("filter factor {:.4g}\n", r.filter_factor);
    if (const auto& fit = r.camera_fit)
        text += fmt::format("camera: CIEDE2000 {:.2f} on average, {:.2f} at most, of the 24 ColorChecker patches under D65\n",
                            fit->mean_difference, fit->largest_difference);
    if (c.fallback_pixels > 0)
        text += fmt::format("{} few samples; filtered without negative weights\n",
                            counted(c.fallback_pixels, "pixel") + (c.fallback_pixels == 1 ? " has" : " have"));
    if (c.empty_pixels > 0)
        text += c.empty_pixels == 1 ? "1 pixel has no camera record; it is black\n"
                                    : fmt::format("{} pixels have no camera record; they are black\n", c.empty_pixels);
    return text;
}

std::vector<std::string> losses(const PictureReport& r) {
    std::vector<std::string> lines;
    for (const sampledb::LeftOut& item : r.run_set.left_out) lines.push_back(item.place + ": left out: " + item.reason);
    if (!r.missing.empty()) lines.push_back(fmt::format("samples {} are in no file", to_string(r.missing)));
    const DevelopCounts& c = r.counts;
    if (c.camera_not_finite > 0)
        lines.push_back(fmt::format("{} camera records are not finite; counted as black", c.camera_not_finite));
    if (c.light_not_finite > 0)
        lines.push_back(fmt::format("{} light records are not finite; counted as zero", c.light_not_finite));
    return lines;
}

}  // namespace latent::develop
