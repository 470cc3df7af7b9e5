// render/load/obj/statements.h: the lines of OBJ and MTL files: a keyword and what follows it [Wavefront].
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/load/files/diagnostics.h"

namespace latent::render {

// Whether a text is UTF-16, as some editors write it; the mark at its beginning says so.
bool is_utf16(std::string_view text);
inline constexpr std::string_view kUtf16 = "is UTF-16; only UTF-8 is read (iconv -f UTF-16 -t UTF-8 OLD > NEW)";

// The number that a whole word is; none if float cannot hold it.
std::optional<double> finite_number(std::string_view word);

// Goes through a text, which outlives it. Lines end as on any system. Comments and empty lines are passed over; a backslash joins a
// line with the next.
class Statements {
 public:
    // `name` begins every message.
    Statements(std::string_view text, std::string name, Diagnostics& diagnostics)
        : text_(text), name_(std::move(name)), diagnostics_(&diagnostics) {}

    // The next statement becomes the current one. False: there is none.
    bool next();
    std::string_view keyword() const { return words_[0]; }
    const std::vector<std::string_view>& words() const { return words_; }  // the keyword first
    // All from word `first` on, to before word `end` or to the last, without quotes about it: names may hold spaces.
    std::string rest(std::size_t first = 1, std::size_t end = static_cast<std::size_t>(-1)) const;

    // Word `i` as a finite number; an error if it is none.
    double number(std::size_t i) const;
    // One that is not finite is 0, with a warning.
    double number_or_zero(std::size_t i) const;
    // `count` numbers after the keyword.
    bool has_numbers(std::size_t count) const;

    // "cube.obj:12": of the current statement.
    std::string place() const { return name_ + ":" + std::to_string(line_); }
    void error(const std::string& message) const { diagnostics_->error(place(), message); }
    void warn(const std::string& message) const { diagnostics_->warn(place(), message); }
    void warn_of_kind(const std::string& kind, const std::string& message) const {
        diagnostics_->warn_of_kind(kind, place(), message);
    }
    // A note or a warning of that kind: `message`, and why.
    void say_of_unread(const std::string& kind, const std::string& message, const UnreadFeatures& unread) const {
        diagnostics_->say_of_unread(kind, place(), message, unread);
    }

 private:
    std::string_view text_;
    std::string name_;
    Diagnostics* diagnostics_;
    std::string joined_;  // a statement of several lines
    std::vector<std::string_view> words_;
    std::uint64_t line_ = 0, next_line_ = 1;
};

}  // namespace latent::render
