// render/load/pbrt/directive.h: the sentences of a .pbrt file: a directive, its arguments and its parameter list.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/load/pbrt/tokenizer.h"

namespace latent::render {

// "type name" [ values ]: one of the three arrays holds the values, as the type demands (a spectrum: numbers, or one string).
struct Parameter {
    std::string type{}, name{};
    SourceLocation where{};
    std::vector<double> numbers{};
    std::vector<std::string> strings{};
    std::vector<bool> flags{};
    bool inherited = false;     // from an Attribute directive: need not be of use
    mutable bool used = false;  // it was read
};

struct Directive {
    std::string name{};
    SourceLocation where{};
    std::vector<std::string> strings{};  // quoted arguments before the parameters: "perspective"
    std::vector<double> numbers{};       // for transformations
    std::vector<Parameter> parameters{};
};

class DirectiveReader {
 public:
    // `text` must outlive the reader. `is_v3`: it is in the language of pbrt-v3, whose types get the names of pbrt-v4; but xyz
    // stays.
    DirectiveReader(std::string_view text, std::uint32_t file, bool is_v3 = false) : tokens_(text, file), is_v3_(is_v3) {}

    // The next directive; nothing at the end. Any error is one of syntax: the directive is lost, and the call after that goes on
    // at the next word that begins one.
    tl::expected<std::optional<Directive>, ParseError> next();

 private:
    tl::expected<std::optional<Directive>, ParseError> directive();
    // What is missing is an error of the directive or parameter, `of`, whose line may be long past.
    ParseError missing(const SourceLocation& where, std::string_view of, std::string_view what, const std::optional<Token>& found);
    tl::expected<Token, ParseError> require(Token::Kind kind, const Directive& of, std::string_view what);
    tl::expected<double, ParseError> number(const Directive& of);
    tl::expected<std::optional<Parameter>, ParseError> parameter();

    Tokenizer tokens_;
    const bool is_v3_;
    bool is_lost_ = false;  // after an error
};

}  // namespace latent::render
