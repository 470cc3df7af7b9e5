#include "render/load/load_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "render/load/foreign_format.h"
#include "render/load/pbrt/builder.h"

namespace latent::render {

namespace {

constexpr std::size_t kMaxIncludes = 64;  // one inside another

class Loader {
 public:
    Loader(const std::filesystem::path& path, bool replace_integrator)
        : path_(path),
          files_(path),
          diagnostics_(scene_.description.files),
          builder_(scene_.description, files_, diagnostics_, replace_integrator) {}

    Result<LoadedScene> load() {
        if (const Status read = file(path_, 0); !read) return read.error();
        builder_.finish(end_);
        if (!diagnostics_.errors().empty())
            return Error{ErrorCode::kUnsupported, fmt::format("{}", fmt::join(diagnostics_.errors(), "\n"))};
        scene_.warnings = diagnostics_.warnings();
        return std::move(scene_);
    }

 private:
    Status file(const std::filesystem::path& path, std::size_t depth) {
        const Result<std::string> text = SceneFiles::read_text(path);
        if (!text) return text.error();
        std::vector<std::string>& names = scene_.description.files;
        const auto index = static_cast<std::uint32_t>(names.size());
        names.push_back(path.string());
        DirectiveReader reader(*text, index);
        while (true) {
            const auto directive = reader.next();
            if (!begun_ && !(directive && *directive)) {
                const std::string_view format = foreign_format(*text);
                if (!format.empty() || directive) return not_pbrt(path, format);
            }
            if (!directive) return syntax_error(directive.error());
            if (!*directive) break;
            begun_ = true;
            const Directive& d = **directive;
            end_ = d.where;
            if (d.name != "Include" && d.name != "Import") {
                builder_.apply(d);
                continue;
            }
            if (depth == kMaxIncludes)
                return syntax_error({d.where, fmt::format("{}: files are nested more than {} deep", d.name, kMaxIncludes)});
            const bool import = d.name == "Import";
            if (import && !builder_.in_world()) return syntax_error({d.where, "Import: must come after WorldBegin"});
            if (import) builder_.begin_import(d.where);
            const Status included = file(files_.resolve(d.strings[0]), depth + 1);
            if (!included && included.error().code == ErrorCode::kCorrupt) return included;
            if (!included) {
                diagnostics_.error(d.where, included.error().message);
                builder_.set_incomplete();
            }
            if (import) builder_.end_import(d.where);
        }
        return {};
    }

    static Error not_pbrt(const std::filesystem::path& path, std::string_view format) {
        return {ErrorCode::kForeign, fmt::format("{}: not a pbrt-v4 scene, the only supported format: {}", path.string(),
                                                 format.empty() ? "the file is empty" : format)};
    }

    // Ends the loading at once; what was found before is told too.
    Error syntax_error(const ParseError& error) {
        diagnostics_.error(error.where, error.message);
        return {ErrorCode::kCorrupt, fmt::format("{}", fmt::join(diagnostics_.errors(), "\n"))};
    }

    std::filesystem::path path_;
    LoadedScene scene_;
    SceneFiles files_;
    Diagnostics diagnostics_;
    SceneBuilder builder_;
    SourceLocation end_;
    bool begun_ = false;  // there was a directive
};

}  // namespace

Result<LoadedScene> load_scene(const std::filesystem::path& path, bool replace_integrator) {
    return Loader(path, replace_integrator).load();
}

}  // namespace latent::render
