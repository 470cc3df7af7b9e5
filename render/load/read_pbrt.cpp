#include "render/load/read_pbrt.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "render/load/pbrt/builder.h"
#include "render/load/pbrt/features.h"
#include "render/load/pbrt/from_v3.h"
#include "render/load/scene_format.h"

namespace latent::render {

namespace {

constexpr std::size_t kMaxIncludes = 64;  // one inside another

Model nothing_with(color::RgbSpectra rgb_spectra) {
    Model model;
    model.scene.rgb_spectra = rgb_spectra;
    return model;
}

class PbrtLoader {
 public:
    // `is_v3`: in the language of pbrt-v3.
    PbrtLoader(const std::filesystem::path& path, const PbrtUse& use, color::RgbSpectra rgb_spectra,
               std::vector<std::string>& names, Diagnostics& diagnostics, bool is_v3)
        : path_(path),
          model_(nothing_with(rgb_spectra)),
          files_(path),
          names_(names),
          diagnostics_(diagnostics),
          builder_(model_.scene, files_, diagnostics_, use),
          is_v3_(is_v3),
          from_v3_(diagnostics) {}

    // Reading ended where the scene turned out to be in the language of pbrt-v3.
    bool turned_out_as_v3() const { return !is_v3_ && found_ == 3; }

    Result<Model> load() {
        if (is_v3_) diagnostics_.note(path_.string(), "is a scene for pbrt-v3, and is read as pbrt-v4 would say it");
        if (const Status read = file(path_, 0); !read) return read.error();
        if (!stopped_) builder_.finish(end_);
        files_.tell_of_other_names(path_, diagnostics_);
        if (!diagnostics_.errors().empty()) return Error{garbled_ ? ErrorCode::kCorrupt : ErrorCode::kUnsupported, errors()};
        model_.shapes = builder_.take_shapes();
        model_.objects = builder_.take_object_shapes();
        model_.has_camera = builder_.options().has_camera();
        model_.has_integrator = builder_.options().has_integrator();
        return std::move(model_);
    }

 private:
    // Errors: the file cannot be read, or is none of pbrt's; what is wrong in it goes to the diagnostics.
    Status file(const std::filesystem::path& path, std::size_t depth) {
        const Result<std::string> text = files_.include(path);
        if (!text) {
            stopped_ = text.error().code == ErrorCode::kOutOfRange;  // so would be the rest
            return text.error();
        }
        const auto [index, is_new] = indexes_.try_emplace(path, static_cast<std::uint32_t>(names_.size()));
        if (is_new) names_.push_back(path.string());
        DirectiveReader reader(*text, index->second, is_v3_);
        bool begun = false;  // there was a directive
        while (!stopped_) {
            auto directive = reader.next();
            if (!begun && !(directive && *directive)) {
                const std::string_view format = foreign_format(*text);
                if (!format.empty() || (directive && depth == 0)) return not_pbrt(path, format);
                // What a scene includes may be any file of this machine: it is not quoted.
                if (!directive && depth > 0 && directive.error().pbrt_version == 4)
                    return not_pbrt(path, "its first word is not a directive");
            }
            begun = true;
            if (!directive) {
                lose(directive.error());
                found_ = directive.error().pbrt_version;
                stopped_ = found_ != 4;  // there would be an error of this kind in every line
                continue;
            }
            if (!*directive) break;
            Directive d = std::move(**directive);
            end_ = d.where;
            if (!is_v3_ && is_of_pbrt_v3(d)) {
                found_ = 3;
                stopped_ = true;
            } else if (d.name == "Include" || d.name == "Import") {
                include(d, depth);
            } else if (is_v3_) {
                for (const Directive& translated : from_v3_.translate(std::move(d))) builder_.apply(translated);
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
        const std::string all = fmt::format("{}", fmt::join(diagnostics_.errors(), "\n"));
        if (found_ != 2) return all;
        return fmt::format("{}: is a scene for pbrt-v2, which is not supported; pbrt-v3 and pbrt-v4 are\n{}", path_.string(), all);
    }

    std::filesystem::path path_;
    Model model_;
    SceneFiles files_;
    std::vector<std::string>& names_;
    Diagnostics& diagnostics_;
    SceneBuilder builder_;
    SourceLocation end_;
    std::vector<std::filesystem::path> open_{path_};          // each included by the one before
    std::map<std::filesystem::path, std::uint32_t> indexes_;  // in names_
    const bool is_v3_;
    FromPbrtV3 from_v3_;
    int found_ = 4;         // the version of pbrt that a type or a word belongs to
    bool garbled_ = false;  // there was an error of syntax
    bool stopped_ = false;  // nothing more is read
};

}  // namespace

Result<Model> read_pbrt(const std::filesystem::path& path, const PbrtUse& use, color::RgbSpectra rgb_spectra,
                        std::vector<std::string>& names, Diagnostics& diagnostics) {
    const Diagnostics before = diagnostics;
    const std::size_t known = names.size();
    {
        PbrtLoader loader(path, use, rgb_spectra, names, diagnostics, false);
        Result<Model> model = loader.load();
        if (!loader.turned_out_as_v3()) return model;
    }
    diagnostics = before;
    names.resize(known);
    return PbrtLoader(path, use, rgb_spectra, names, diagnostics, true).load();
}

}  // namespace latent::render
