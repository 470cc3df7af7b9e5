#include "render/load/pbrt/tokenizer.h"

#include <charconv>
#include <cmath>

namespace latent::render {

namespace {
bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool ends_word(char c) { return is_space(c) || c == '"' || c == '[' || c == ']' || c == '#'; }
}  // namespace

char Tokenizer::take() {
    const char c = text_[at_++];
    if (c == '\n') {
        ++here_.line;
        here_.column = 1;
    } else {
        ++here_.column;
    }
    return c;
}

tl::expected<std::optional<Token>, ParseError> Tokenizer::next() {
    if (pending_) {
        const std::optional<Token> token = pending_;
        pending_.reset();
        return token;
    }
    while (at_ < text_.size()) {
        const SourceLocation where = here_;
        const std::size_t begin = at_;
        const char c = take();
        if (is_space(c)) continue;
        if (c == '#') {
            while (at_ < text_.size() && text_[at_] != '\n') take();
            continue;
        }
        if (c == '"') return string(where);
        if (c == '[') return Token{Token::Kind::kOpen, text_.substr(begin, 1), where};
        if (c == ']') return Token{Token::Kind::kClose, text_.substr(begin, 1), where};
        while (at_ < text_.size() && !ends_word(text_[at_])) take();
        return Token{Token::Kind::kWord, text_.substr(begin, at_ - begin), where};
    }
    return std::optional<Token>{};
}

tl::expected<std::optional<Token>, ParseError> Tokenizer::string(SourceLocation where) {
    const std::size_t begin = at_;
    bool escapes = false;
    while (true) {
        if (at_ == text_.size() || text_[at_] == '\n') return tl::unexpected(ParseError{where, "string without closing quote"});
        const char c = take();
        if (c == '"') break;
        if (c == '\\') {
            escapes = true;
            if (at_ == text_.size()) continue;
            take();
        }
    }
    const std::string_view raw = text_.substr(begin, at_ - 1 - begin);
    if (!escapes) return Token{Token::Kind::kString, raw, where};

    static constexpr std::string_view kCodes = "bfnrt\\'\"", kMeanings = "\b\f\n\r\t\\'\"";
    decoded_.clear();
    for (std::size_t i = 0; i < raw.size(); ++i) {
        if (raw[i] != '\\') {
            decoded_ += raw[i];
            continue;
        }
        const std::size_t code = ++i < raw.size() ? kCodes.find(raw[i]) : std::string_view::npos;
        if (code == std::string_view::npos) return tl::unexpected(ParseError{where, "unknown escape in string"});
        decoded_ += kMeanings[code];
    }
    return Token{Token::Kind::kString, decoded_, where};
}

std::optional<double> parse_number(std::string_view text) {
    if (text.starts_with('+')) {
        text.remove_prefix(1);
        if (text.starts_with('-')) return std::nullopt;
    }
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

}  // namespace latent::render
