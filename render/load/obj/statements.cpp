#include "render/load/obj/statements.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace latent::render {

namespace {

constexpr std::string_view kBlank = " \t\r\f\v";

// Takes one line off the front, without its end.
std::string_view take_line(std::string_view& text) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end);
    text.remove_prefix(text.starts_with("\r\n") ? 2 : std::min<std::size_t>(1, text.size()));
    return line;
}

}  // namespace

bool is_utf16(std::string_view text) { return text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"); }

bool Statements::next() {
    while (!text_.empty()) {
        line_ = next_line_++;
        std::string_view line = take_line(text_);
        if (line.ends_with('\\')) {
            joined_.clear();
            for (; line.ends_with('\\'); ++next_line_) {
                joined_.append(line.substr(0, line.size() - 1)).push_back(' ');
                line = text_.empty() ? std::string_view() : take_line(text_);
            }
            joined_ += line;
            line = joined_;
        }
        line = line.substr(0, line.find('#'));
        words_.clear();
        for (std::size_t at = line.find_first_not_of(kBlank); at != line.npos; at = line.find_first_not_of(kBlank, at)) {
            const std::size_t end = std::min(line.find_first_of(kBlank, at), line.size());
            words_.push_back(line.substr(at, end - at));
            at = end;
        }
        if (!words_.empty()) return true;
    }
    return false;
}

std::string Statements::rest(std::size_t first, std::size_t end) const {
    end = std::min(end, words_.size());
    if (end <= first) return "";
    const char* const begin = words_[first].data();
    const std::string_view last = words_[end - 1], all(begin, static_cast<std::size_t>(last.data() + last.size() - begin));
    const bool is_quoted = all.size() >= 2 && all.starts_with('"') && all.ends_with('"');
    return std::string(is_quoted ? all.substr(1, all.size() - 2) : all);
}

std::optional<double> finite_number(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double x = 0;
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), x);
    const bool is_read = fault == std::errc{} && end == word.data() + word.size() && std::isfinite(static_cast<float>(x));
    return is_read ? std::optional(x) : std::nullopt;
}

double Statements::number(std::size_t i) const {
    if (i >= words_.size()) {
        error(fmt::format("{}: a number is missing", keyword()));
        return 0;
    }
    if (const std::optional<double> x = finite_number(words_[i])) return *x;
    error(fmt::format("{}: \"{}\" is not a finite number", keyword(), std::string(words_[i].substr(0, 40))));
    return 0;
}

double Statements::number_or_zero(std::size_t i) const {
    double x = 0;
    const std::string_view word = i < words_.size() ? words_[i] : std::string_view();
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), x);
    if (fault != std::errc{} || end != word.data() + word.size() || std::isfinite(x)) return number(i);
    warn_of_kind("not finite", fmt::format("{}: \"{}\" is not a finite number, and counts as 0", keyword(), word));
    return 0;
}

bool Statements::has_numbers(std::size_t count) const {
    if (words_.size() > count) return true;
    error(fmt::format("{}: must be followed by {} numbers", keyword(), count));
    return false;
}

}  // namespace latent::render
