// render/load/pbrt/tokenizer.h: the words of a .pbrt file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"
#include "render/scene/description.h"

namespace latent::render {

struct Token {
    enum class Kind : std::uint8_t { kWord, kString, kOpen, kClose };
    Kind kind = Kind::kWord;
    std::string_view text;  // a string's without its quotes; valid until the next token is read, or as long as the file's text
    SourceLocation where;
};

// An error that names no file; the location says where.
struct ParseError {
    SourceLocation where;
    std::string message;
    int pbrt_version = 4;  // 2 or 3: what was read belongs to that format
};

class Tokenizer {
 public:
    // `text` must outlive the tokenizer.
    Tokenizer(std::string_view text, std::uint32_t file) : text_(text), here_{file, 1, 1} {}

    // The next token; nothing at the end. Comments run from # to the end of the line.
    tl::expected<std::optional<Token>, ParseError> next();
    void unget(const Token& token) { pending_ = token; }
    SourceLocation here() const { return here_; }

 private:
    char take();
    tl::expected<std::optional<Token>, ParseError> string(SourceLocation where);

    std::string_view text_;
    std::size_t at_ = 0;
    SourceLocation here_;
    std::optional<Token> pending_;
    std::string decoded_;  // the last string with escapes
};

// A decimal number, sign and exponent allowed; nothing for anything else, infinities and NaN included.
std::optional<double> parse_number(std::string_view text);

}  // namespace latent::render
