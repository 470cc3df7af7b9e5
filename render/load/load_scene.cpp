#include "render/load/load_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

#include "base/file.h"
#include "render/load/gltf/gltf.h"
#include "render/load/obj/obj.h"
#include "render/load/pbrt/builder.h"
#include "render/load/pbrt/features.h"
#include "render/load/scene_format.h"

namespace latent::render {

namespace {

constexpr std::size_t kMaxIncludes = 64;   // one inside another
constexpr std::size_t kBeginning = 65536;  // bytes that a format is recognised by

std::string all_of(const std::vector<std::string>& messages) { return fmt::format("{}", fmt::join(messages, "\n")); }

LoadedScene nothing_with(color::RgbSpectra rgb_spectra) {
    LoadedScene scene;
    scene.description.rgb_spectra = rgb_spectra;
    return scene;
}

class PbrtLoader {
 public:
    PbrtLoader(const std::filesystem::path& path, bool replace_integrator, color::RgbSpectra rgb_spectra)
        : path_(path),
          scene_(nothing_with(rgb_spectra)),
          files_(path),
          diagnostics_(scene_.description.files),
          builder_(scene_.description, files_, diagnostics_, replace_integrator) {}

    Result<LoadedScene> load() {
        if (const Status read = file(path_, 0); !read) return read.error();
        if (!stopped_) builder_.finish(end_);
        if (!diagnostics_.errors().empty()) return Error{garbled_ ? ErrorCode::kCorrupt : ErrorCode::kUnsupported, errors()};
        scene_.warnings = diagnostics_.warnings();
        scene_.notes = diagnostics_.notes();
        return std::move(scene_);
    }

 private:
    // Errors: the file cannot be read, or is none of pbrt's; what is wrong in it goes to the diagnostics.
    Status file(const std::filesystem::path& path, std::size_t depth) {
        const Result<std::string> text = files_.include(path);
        if (!text) {
            stopped_ = text.error().code == ErrorCode::kOutOfRange;  // so would be the rest
            return text.error();
        }
        std::vector<std::string>& names = scene_.description.files;
        const auto [index, is_new] = indexes_.try_emplace(path, static_cast<std::uint32_t>(names.size()));
        if (is_new) names.push_back(path.string());
        DirectiveReader reader(*text, index->second);
        bool begun = false;  // there was a directive
        while (!stopped_) {
            const auto directive = reader.next();
            if (!begun && !(directive && *directive)) {
                const std::string_view format = foreign_format(*text);
                if (!format.empty() || (directive && depth == 0)) return not_pbrt(path, format);
                // What a scene includes may be any file of this machine: it is not quoted.
                if (!directive && depth > 0 && !directive.error().is_of_pbrt_v3)
                    return not_pbrt(path, "its first word is not a directive");
            }
            begun = true;
            if (!directive) {
                lose(directive.error());
                is_v3_ = is_v3_ || directive.error().is_of_pbrt_v3;
                stopped_ = is_v3_;  // there would be an error of this kind in every line
                continue;
            }
            if (!*directive) break;
            const Directive& d = **directive;
            end_ = d.where;
            is_v3_ = is_v3_ || (!d.strings.empty() && is_of_pbrt_v3(d.name, d.strings[0]));
            if (d.name == "Include" || d.name == "Import") {
                include(d, depth);
            } else {
                builder_.apply(d);
            }
        }
        return {};
    }

    void include(const Directive& d, std::size_t depth) {
        const bool import = d.name == "Import";
        const std::filesystem::path path = files_.resolve(d.strings[0]);
        if (std::ranges::find(open_, path) != open_.end()) {
            stopped_ = true;
            return lose(
                {d.where, fmt::format("{}: the file includes itself{}", d.name, path == open_.back() ? "" : " by way of others")});
        }
        if (depth == kMaxIncludes) {
            stopped_ = true;  // it may include itself more than once
            return lose({d.where, fmt::format("{}: files are nested more than {} deep", d.name, kMaxIncludes)});
        }
        if (import && !builder_.in_world()) return lose({d.where, "Import: must come after WorldBegin"});
        if (import) builder_.begin_import(d.where);
        open_.push_back(path);
        if (const Status included = file(path, depth + 1); !included) {
            diagnostics_.error(d.where, included.error().message);
            builder_.set_incomplete();
        }
        open_.pop_back();
        if (import) builder_.end_import(d.where);
    }

    void lose(const ParseError& error) {
        diagnostics_.error(error.where, error.message);
        builder_.set_incomplete();
        garbled_ = true;
    }

    static Error not_pbrt(const std::filesystem::path& path, std::string_view format) {
        return {ErrorCode::kForeign, fmt::format("{}: not a scene in a supported format (pbrt-v4, glTF 2.0, OBJ): {}",
                                                 path.string(), format.empty() ? "the file is empty" : format)};
    }

    std::string errors() const {
        const std::string all = all_of(diagnostics_.errors());
        if (!is_v3_) return all;
        return fmt::format(
            "{}: seems to be a scene for pbrt-v3; pbrt-v4 converts such scenes: pbrt --upgrade OLD.pbrt > NEW.pbrt\n{}",
            path_.string(), all);
    }

    std::filesystem::path path_;
    LoadedScene scene_;
    SceneFiles files_;
    Diagnostics diagnostics_;
    SceneBuilder builder_;
    SourceLocation end_;
    std::vector<std::filesystem::path> open_{path_};          // each included by the one before
    std::map<std::filesystem::path, std::uint32_t> indexes_;  // in the description's list of files
    bool is_v3_ = false;                                      // one had a type or a word of pbrt-v3
    bool garbled_ = false;                                    // there was an error of syntax
    bool stopped_ = false;                                    // nothing more is read
};

Result<LoadedScene> load_model(const std::filesystem::path& path, SceneFormat format, color::RgbSpectra rgb_spectra,
                               const ModelOptions& options) {
    Result<std::string> bytes = SceneFiles::read_text(path);
    if (!bytes) return bytes.error();
    if (format == SceneFormat::kObj && (bytes->empty() || bytes->find('\0') != bytes->npos))
        return Error{ErrorCode::kForeign, fmt::format("{}: not a Wavefront OBJ file: {}", path.string(),
                                                      bytes->empty() ? "the file is empty" : "it is binary")};
    LoadedScene scene = nothing_with(rgb_spectra);
    scene.description.files.push_back(path.string());
    Diagnostics diagnostics(scene.description.files);
    SceneFiles files(path);
    const ModelColors colors(rgb_spectra);
    Result<Model> model = format == SceneFormat::kGltf ? read_gltf(*bytes, path.string(), files, colors, options, diagnostics)
                                                       : read_obj(*bytes, path.string(), files, colors, diagnostics);
    if (!model) return model.error();
    if (!diagnostics.errors().empty()) return Error{ErrorCode::kUnsupported, all_of(diagnostics.errors())};
    if (model->shapes.empty() && model->scene.instances.empty())
        return Error{ErrorCode::kUnsupported, path.string() + ": has no triangles"};
    const auto missing = [&](std::string_view what, const std::string& name, const std::vector<std::string>& names) {
        return usage_error(fmt::format("--{0} {1}: {2} has no {0} of this name{3}", what, name, path.string(),
                                       names.empty() ? "" : fmt::format(" ({})", fmt::join(names, ", "))));
    };
    if (!options.camera.empty() && !model->has_camera) return missing("camera", options.camera, model->cameras);
    if (!options.variant.empty() && !model->has_variant) return missing("variant", options.variant, model->variants);
    scene.embedded = std::move(model->embedded);
    const Result<std::vector<std::string>> added =
        complete(std::move(*model), options, colors.emission({1, 1, 1}), scene.description);
    if (!added) return added.error();
    for (const std::string& what : *added) scene.added.push_back(fmt::format("{}: {}", path.string(), what));
    scene.description.rgb_spectra = rgb_spectra;
    scene.warnings = diagnostics.warnings();
    scene.notes = diagnostics.notes();
    return scene;
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

}  // namespace

Result<LoadedScene> load_scene(const std::filesystem::path& path, bool replace_integrator, color::RgbSpectra rgb_spectra,
                               const ModelOptions& model) {
    const Result<std::string> beginning = beginning_of(path);
    if (!beginning) return beginning.error();
    const SceneFormat format = scene_format(path, *beginning);
    if (format != SceneFormat::kPbrt) return load_model(path, format, rgb_spectra, model);
    if (model != ModelOptions{})
        return usage_error(fmt::format(
            "{}: --camera, --variant, --view, --up, --no-stage, --lens-radius, --focus and --sky are for glTF and OBJ; a pbrt "
            "scene says these itself",
            path.string()));
    return PbrtLoader(path, replace_integrator, rgb_spectra).load();
}

}  // namespace latent::render
