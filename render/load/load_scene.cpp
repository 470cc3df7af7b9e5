#include "render/load/load_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.h"
#include "render/load/gltf/gltf.h"
#include "render/load/model/append.h"
#include "render/load/obj/obj.h"
#include "render/load/obj/statements.h"
#include "render/load/read_pbrt.h"
#include "render/load/scene_format.h"

namespace latent::render {

namespace {

constexpr std::size_t kBeginning = 65536;  // bytes that a format is recognised by

Result<Model> read_model(const std::filesystem::path& path, SceneFormat format, const ModelColors& colors,
                         const ModelOptions& options, std::vector<std::string>& names, Diagnostics& diagnostics) {
    Result<std::string> bytes = SceneFiles::read_text(path);
    if (!bytes) return bytes.error();
    if (is_lfs_pointer(*bytes)) return Error{ErrorCode::kForeign, fmt::format("{}: {}", path.string(), kLfsPointer)};
    if (format == SceneFormat::kObj && is_utf16(*bytes))
        return Error{ErrorCode::kForeign, fmt::format("{}: {}", path.string(), kUtf16)};
    if (format == SceneFormat::kObj && (bytes->empty() || bytes->find('\0') != bytes->npos))
        return Error{ErrorCode::kForeign, fmt::format("{}: not a Wavefront OBJ file: {}", path.string(),
                                                      bytes->empty() ? "the file is empty" : "it is binary")};
    names.push_back(path.string());
    SceneFiles files(path);
    Result<Model> model = format == SceneFormat::kGltf ? read_gltf(*bytes, path.string(), files, colors, options, diagnostics)
                                                       : read_obj(*bytes, path.string(), files, colors, diagnostics);
    files.tell_of_other_names(path, diagnostics);
    if (!model) return model.error();
    if (!diagnostics.errors().empty())
        return Error{ErrorCode::kUnsupported, fmt::format("{}", fmt::join(diagnostics.errors(), "\n"))};
    if (model->shapes.empty() && model->scene.instances.empty())
        return Error{ErrorCode::kUnsupported, path.string() + ": has no triangles; points and lines are not drawn"};
    const auto missing = [&](std::string_view what, const std::string& name, std::string_view key,
                             const std::vector<std::string>& all) {
        return usage_error(fmt::format("--{0} {1}: {2} has no {0} of this {3}{4}", what, name, path.string(), key,
                                       all.empty() ? "" : fmt::format(" ({})", fmt::join(all, ", "))));
    };
    if (!options.camera.empty() && !model->has_camera) return missing("camera", options.camera, "name or number", model->cameras);
    if (!options.animation.empty() && !model->has_animation)
        return missing("animation", options.animation, "name or number", model->animations);
    if ((options.time || options.shutter) && !model->has_animation)
        return usage_error(fmt::format("--{}: {} has no animation", options.time ? "time" : "shutter", path.string()));
    if (!options.variant.empty() && !model->has_variant) return missing("variant", options.variant, "name", model->variants);
    return model;
}

// As much of a file as a format is recognised by.
Result<std::string> beginning_of(const std::filesystem::path& path) {
    const Result<File> file = File::open_read(path);
    if (!file) return file.error();
    std::string text(kBeginning, '\0');
    const Result<std::size_t> size = file->read_some(0, std::as_writable_bytes(std::span(text)));
    if (!size) return size.error();
    text.resize(*size);
    return text;
}

Result<SceneFormat> format_of(const std::filesystem::path& path) {
    const Result<std::string> beginning = beginning_of(path);
    if (!beginning) return beginning.error();
    return scene_format(path, *beginning);
}

}  // namespace

Result<LoadedScene> load_scene(const std::filesystem::path& path, bool replace_integrator, color::RgbSpectra rgb_spectra,
                               const ModelOptions& options, const std::vector<std::filesystem::path>& additions) {
    const Result<SceneFormat> format = format_of(path);
    if (!format) return format.error();
    const bool is_model = *format != SceneFormat::kPbrt;
    if (!is_model && options != ModelOptions{.aspect = options.aspect})
        return usage_error(
            fmt::format("{}: --camera, --variant, --animation, --time, --shutter, --view, --up, --no-stage, --lens-radius, --focus "
                        "and --sky are for glTF and OBJ; a pbrt scene says these itself",
                        path.string()));
    LoadedScene scene;
    std::vector<std::string> names;
    Diagnostics diagnostics(names);
    const ModelColors colors(rgb_spectra);
    Result<Model> model = is_model ? read_model(path, *format, colors, options, names, diagnostics)
                                   : read_pbrt(path, {.replaces_integrator = replace_integrator}, rgb_spectra, names, diagnostics);
    if (!model) return model.error();
    if (is_model) model->scene.max_depth = kUnlimited;  // a path through two glasses meets eight surfaces
    scene.embedded = std::move(model->embedded);
    std::vector<Model> more;
    for (const std::filesystem::path& addition : additions) {
        const Result<SceneFormat> its_format = format_of(addition);
        if (!its_format) return its_format.error();
        if (*its_format != SceneFormat::kPbrt)
            return usage_error(fmt::format("--add {}: must be in the language of pbrt (.pbrt)", addition.string()));
        const PbrtUse use{.replaces_integrator = replace_integrator, .is_addition = true, .is_right_handed = is_model};
        Result<Model> read = read_pbrt(addition, use, rgb_spectra, names, diagnostics);
        if (!read) return read.error();
        more.push_back(std::move(*read));
    }
    if (is_model) {
        const Result<std::vector<std::string>> added = complete(*model, std::move(more), options, colors.emission({1, 1, 1}));
        if (!added) return added.error();
        for (const std::string& what : *added) scene.added.push_back(fmt::format("{}: {}", path.string(), what));
    } else {
        for (Model& one : more) append(std::move(one), *model);
    }
    scene.description = std::move(model->scene);
    scene.description.rgb_spectra = rgb_spectra;
    place(std::move(model->shapes), std::move(model->objects), scene.description);
    scene.warnings = diagnostics.warnings();
    scene.notes = diagnostics.notes();
    scene.description.files = std::move(names);
    return scene;
}

}  // namespace latent::render
