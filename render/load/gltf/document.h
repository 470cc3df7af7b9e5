// render/load/gltf/document.h: the text and the binary buffers of a glTF 2.0 file, .gltf or .glb [glTF2].
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "render/load/files/diagnostics.h"
#include "render/load/files/scene_files.h"
#include "render/load/gltf/value.h"

namespace latent::render {

class GltfDocument {
 public:
    // `bytes`: the content of a file; `name` begins every message. Errors: kTruncated, kCorrupt, kUnsupported: nothing else can be
    // read. What is wrong in it, or with its buffers, goes to `diagnostics`. `files` and `diagnostics` outlive the document.
    static Result<GltfDocument> read(const std::string& bytes, const std::string& name, SceneFiles& files,
                                     Diagnostics& diagnostics);

    GltfValue root() const { return {&json_, name_ + ": ", *diagnostics_}; }
    // Whether its members are what they should be (schema.h); else there were errors, and there are no buffers.
    bool is_sound() const { return is_sound_; }
    // The bytes of /buffers/i; null if there was an error.
    const std::string* buffer(std::size_t i) const { return buffers_[i].get(); }
    // The bytes of /bufferViews/i if they were compressed; else null: then they are in its buffer.
    const std::string* unpacked_view(std::size_t i) const { return i < views_.size() ? views_[i].get() : nullptr; }
    // What "uri" says, relative to the file: a "data:" URI or a file. Nothing, with an error, if it cannot be read.
    std::optional<std::string> resource(const GltfValue& uri) const;
    SceneFiles& files() const { return *files_; }

 private:
    GltfDocument(std::string name, SceneFiles& files, Diagnostics& diagnostics)
        : name_(std::move(name)), files_(&files), diagnostics_(&diagnostics) {}
    void read_buffers(std::string_view binary_chunk, bool has_chunk);
    // Whether bytes are taken from each buffer. Buffers that stand in for compressed views are not used.
    std::vector<bool> find_used_buffers() const;
    void unpack_views();

    std::string name_;
    SceneFiles* files_;
    Diagnostics* diagnostics_;
    nlohmann::json json_;
    bool is_sound_ = false;
    std::vector<std::shared_ptr<const std::string>> buffers_;  // one for all that name the same file
    std::vector<std::shared_ptr<const std::string>> views_;    // null: not compressed
};

// The file that a relative URI names, its %-escapes resolved. Nothing if it has a scheme, such as "https:".
std::optional<std::string> file_of_uri(std::string_view uri);

}  // namespace latent::render
