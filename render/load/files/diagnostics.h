// render/load/files/diagnostics.h: what there is to say about a scene: each message names the file, line and column that it is
// about.
#pragma once

#include <string>
#include <vector>

#include "render/scene/description.h"

namespace latent::render {

// Errors are collected, so that one run names everything that a scene needs and this renderer lacks.
class Diagnostics {
 public:
    // `files` names SourceLocation::file.
    explicit Diagnostics(const std::vector<std::string>& files) : files_(files) {}

    // The picture would be wrong: "room.pbrt:12:3: message".
    void error(const SourceLocation& where, const std::string& message) { error(place(where), message); }
    // The picture is what it should be, but something was ignored.
    void warn(const SourceLocation& where, const std::string& message) { warn(place(where), message); }

    // The same of a place that is not a line and column: "room.gltf: /nodes/3".
    void error(const std::string& place, const std::string& message) { errors_.push_back(place + ": " + message); }
    void warn(const std::string& place, const std::string& message) { warnings_.push_back(place + ": " + message); }

    // "room.pbrt:12:3".
    std::string place(const SourceLocation& where) const {
        return files_[where.file] + ":" + std::to_string(where.line) + ":" + std::to_string(where.column);
    }

    const std::vector<std::string>& errors() const { return errors_; }
    const std::vector<std::string>& warnings() const { return warnings_; }

 private:
    const std::vector<std::string>& files_;
    std::vector<std::string> errors_, warnings_;
};

}  // namespace latent::render
