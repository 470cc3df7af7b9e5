// render/load/files/diagnostics.h: what there is to say about a scene: each message names the file, line and column that it is
// about.
#pragma once

#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "render/load/files/unread.h"
#include "render/scene/description.h"

namespace latent::render {

// Errors are collected, so that one run names everything that a scene needs and this renderer lacks.
class Diagnostics {
 public:
    // `files` names SourceLocation::file.
    explicit Diagnostics(const std::vector<std::string>& files) : files_(&files) {}

    // The picture would be wrong: "room.pbrt:12:3: message".
    void error(const SourceLocation& where, const std::string& message) { error(place(where), message); }
    // Something was ignored: the picture may be another one than was meant.
    void warn(const SourceLocation& where, const std::string& message) { warn(place(where), message); }
    // Something was ignored that no sample depends on.
    void note(const SourceLocation& where, const std::string& message) { note(place(where), message); }

    // A file cannot be read: said once, at the first place that names it.
    void unreadable(const SourceLocation& where, const std::string& message) {
        if (unreadable_.insert(message).second) error(where, message);
    }

    // The same of a place that is not a line and column: "room.gltf: /nodes/3".
    void error(const std::string& place, const std::string& message) { say(place, message, errors_); }
    void warn(const std::string& place, const std::string& message) { say(place, message, warnings_); }
    void note(const std::string& place, const std::string& message) { say(place, message, notes_); }

    // What many places may deserve: the first of its kind is said, with how many followed.
    void warn_of_kind(const std::string& kind, const std::string& place, const std::string& message) {
        say_of_kind(kind, place, message, warnings_);
    }
    void note_of_kind(const std::string& kind, const std::string& place, const std::string& message) {
        say_of_kind(kind, place, message, notes_);
    }

    // What is not read (files/unread.h), unless it is usual: a note if it is harmless, else a warning; `message`, and why.
    void say_of_unread(const std::string& kind, const std::string& place, const std::string& message,
                       const UnreadFeatures& unread) {
        if (!unread.is_usual)
            say_of_kind(kind, place, message + ": " + std::string(unread.why), unread.is_harmless ? notes_ : warnings_);
    }

    // "room.pbrt:12:3".
    std::string place(const SourceLocation& where) const {
        return (*files_)[where.file] + ":" + std::to_string(where.line) + ":" + std::to_string(where.column);
    }

    const std::vector<std::string>& errors() const { return errors_.lines; }
    const std::vector<std::string>& warnings() const { return warnings_.lines; }
    const std::vector<std::string>& notes() const { return notes_.lines; }

 private:
    // Each once, however many things use what stands there.
    struct Lines {
        std::vector<std::string> lines;
        std::unordered_set<std::string> said;
    };
    // False: it was said before, or too much was.
    static bool say(const std::string& place, const std::string& message, Lines& out) {
        constexpr std::size_t kMax = 1000, kLongest = 2000;
        if (out.lines.size() == kMax) out.lines.emplace_back("and more like these");
        if (out.lines.size() > kMax) return false;
        std::string line = place + ": " + message;
        if (line.size() > kLongest) line.replace(kLongest, line.npos, "...");
        if (!out.said.insert(line).second) return false;
        out.lines.push_back(std::move(line));
        return true;
    }

    struct Kind {
        std::size_t line = 0;
        std::string text{};  // what the first says; empty if it was not said
        std::unordered_set<std::string> places{};
    };
    void say_of_kind(const std::string& kind, const std::string& place, const std::string& message, Lines& out) {
        const auto [first, is_new] = kinds_.try_emplace(kind);
        Kind& of_kind = first->second;
        if (!of_kind.places.insert(place).second) return;
        if (is_new) {
            of_kind.line = out.lines.size();
            if (say(place, message, out)) of_kind.text = out.lines[of_kind.line];
        } else if (!of_kind.text.empty()) {
            const std::size_t others = of_kind.places.size() - 1;
            out.lines[of_kind.line] =
                of_kind.text + " (and in " + std::to_string(others) + (others == 1 ? " other place)" : " other places)");
        }
    }

    const std::vector<std::string>* files_;
    std::unordered_map<std::string, Kind> kinds_;
    Lines errors_, warnings_, notes_;
    std::unordered_set<std::string> unreadable_;
};

}  // namespace latent::render
