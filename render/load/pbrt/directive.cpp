#include "render/load/pbrt/directive.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/near_names.h"

namespace latent::render {

namespace {

// What follows the name of each directive: quoted strings, then numbers (in brackets or not), then parameters.
struct Grammar {
    std::string_view name;
    int strings = 0;
    int optional_strings = 0;
    int numbers = 0;
    bool brackets = false;
    bool parameters = false;
    bool word = false;  // one bare word or string, kept among the strings
};

constexpr Grammar kGrammar[] = {
    {.name = "Accelerator", .strings = 1, .parameters = true},
    {.name = "ActiveTransform", .word = true},
    {.name = "AreaLightSource", .strings = 1, .parameters = true},
    {.name = "Attribute", .strings = 1, .parameters = true},
    {.name = "AttributeBegin"},
    {.name = "AttributeEnd"},
    {.name = "Camera", .strings = 1, .parameters = true},
    {.name = "ColorSpace", .strings = 1},
    {.name = "ConcatTransform", .numbers = 16, .brackets = true},
    {.name = "CoordSysTransform", .strings = 1},
    {.name = "CoordinateSystem", .strings = 1},
    {.name = "Film", .strings = 1, .parameters = true},
    {.name = "Identity"},
    {.name = "Import", .strings = 1},
    {.name = "Include", .strings = 1},
    {.name = "Integrator", .strings = 1, .parameters = true},
    {.name = "LightSource", .strings = 1, .parameters = true},
    {.name = "LookAt", .numbers = 9},
    {.name = "MakeNamedMaterial", .strings = 1, .parameters = true},
    {.name = "MakeNamedMedium", .strings = 1, .parameters = true},
    {.name = "Material", .strings = 1, .parameters = true},
    {.name = "MediumInterface", .strings = 1, .optional_strings = 1},
    {.name = "NamedMaterial", .strings = 1},
    {.name = "ObjectBegin", .strings = 1},
    {.name = "ObjectEnd"},
    {.name = "ObjectInstance", .strings = 1},
    {.name = "Option", .strings = 1, .word = true},
    {.name = "PixelFilter", .strings = 1, .parameters = true},
    {.name = "ReverseOrientation"},
    {.name = "Rotate", .numbers = 4},
    {.name = "Sampler", .strings = 1, .parameters = true},
    {.name = "Scale", .numbers = 3},
    {.name = "Shape", .strings = 1, .parameters = true},
    {.name = "Texture", .strings = 3, .parameters = true},
    {.name = "Transform", .numbers = 16, .brackets = true},
    {.name = "TransformBegin"},
    {.name = "TransformEnd"},
    {.name = "TransformTimes", .numbers = 2},
    {.name = "Translate", .numbers = 3},
    {.name = "WorldBegin"},
};
constexpr Grammar kWorldEnd{.name = "WorldEnd"};  // pbrt-v3
constexpr std::string_view kOfV2[] = {"Renderer", "SurfaceIntegrator", "Volume", "VolumeIntegrator"};

enum class ValueKind { kNumbers, kFlags, kStrings, kNumbersOrStrings };
struct TypeGrammar {
    std::string_view name;
    ValueKind values;
};
constexpr TypeGrammar kTypes[] = {
    {"integer", ValueKind::kNumbers},   {"float", ValueKind::kNumbers},
    {"point2", ValueKind::kNumbers},    {"vector2", ValueKind::kNumbers},
    {"point3", ValueKind::kNumbers},    {"vector3", ValueKind::kNumbers},
    {"normal", ValueKind::kNumbers},    {"rgb", ValueKind::kNumbers},
    {"blackbody", ValueKind::kNumbers}, {"spectrum", ValueKind::kNumbersOrStrings},
    {"string", ValueKind::kStrings},    {"texture", ValueKind::kStrings},
    {"bool", ValueKind::kFlags},        {"latent:daylight", ValueKind::kNumbers},
};
// Those of pbrt-v3 alone, and what they are called now.
constexpr std::pair<std::string_view, std::string_view> kOldTypes[] = {
    {"color", "rgb"}, {"point", "point3"}, {"vector", "vector3"}, {"xyz", "xyz"}};
constexpr TypeGrammar kXyz{"xyz", ValueKind::kNumbers};

std::string_view new_type(std::string_view old) {
    const auto* const found = std::ranges::find(kOldTypes, old, &std::pair<std::string_view, std::string_view>::first);
    return found == std::end(kOldTypes) ? std::string_view() : found->second;
}

std::string quote(std::string_view text) { return fmt::format("\"{}\"", text.substr(0, 64)); }

const Grammar* grammar_of(const Token& token) {
    for (const Grammar& g : kGrammar) {
        if (token.kind == Token::Kind::kWord && g.name == token.text) return &g;
    }
    return token.kind == Token::Kind::kWord && token.text == kWorldEnd.name ? &kWorldEnd : nullptr;
}

const TypeGrammar* type_of(std::string_view name) {
    const auto* const found = std::ranges::find(kTypes, name, &TypeGrammar::name);
    return found != std::end(kTypes) ? found : name == kXyz.name ? &kXyz : nullptr;
}

// "; did you mean Shape?", or nothing, of the names in a table.
template <class Table>
std::string near(std::string_view word, const Table& table) {
    std::vector<std::string> names;
    for (const auto& row : table) names.emplace_back(row.name);
    const std::string found = near_names(word, names);
    return found.empty() ? "" : fmt::format("; did you mean {}?", found);
}

// Where the next directive begins, or the file ends, nothing more of this one can come.
bool ends_list(const std::optional<Token>& token) { return !token || grammar_of(*token) != nullptr; }

// Both words of "type name"; empty where there are not two.
std::pair<std::string_view, std::string_view> declaration_in(std::string_view text) {
    const std::size_t type_begin = text.find_first_not_of(" \t"), type_end = text.find_first_of(" \t", type_begin);
    const std::size_t name_begin = text.find_first_not_of(" \t", type_end), name_end = text.find_first_of(" \t", name_begin);
    if (name_begin >= text.size() || text.find_first_not_of(" \t", name_end) < text.size()) return {};
    return {text.substr(type_begin, type_end - type_begin), text.substr(name_begin, name_end - name_begin)};
}

}  // namespace

ParseError DirectiveReader::missing(const SourceLocation& where, std::string_view of, std::string_view what,
                                    const std::optional<Token>& found) {
    if (found) tokens_.unget(*found);
    return {where, fmt::format("{}: {} is missing before {}", of, what, found ? quote(found->text) : "the end of the file")};
}

tl::expected<Token, ParseError> DirectiveReader::require(Token::Kind kind, const Directive& of, std::string_view what) {
    const tl::expected<std::optional<Token>, ParseError> token = tokens_.next();
    if (!token) return tl::unexpected(token.error());
    if (ends_list(*token)) return tl::unexpected(missing(of.where, of.name, what, *token));
    if ((*token)->kind != kind)
        return tl::unexpected(ParseError{(*token)->where, fmt::format("{} is not {}", quote((*token)->text), what)});
    return **token;
}

tl::expected<double, ParseError> DirectiveReader::number(const Directive& of) {
    const tl::expected<Token, ParseError> token = require(Token::Kind::kWord, of, "a number");
    if (!token) return tl::unexpected(token.error());
    if (const std::optional<double> value = parse_number(token->text)) return *value;
    return tl::unexpected(ParseError{token->where, quote(token->text) + " is not a finite number"});
}

tl::expected<std::optional<Directive>, ParseError> DirectiveReader::next() {
    while (is_lost_) {
        const tl::expected<std::optional<Token>, ParseError> token = tokens_.next();
        if (!token) continue;
        is_lost_ = !ends_list(*token);
        if (!is_lost_ && *token) tokens_.unget(**token);
    }
    tl::expected<std::optional<Directive>, ParseError> read = directive();
    is_lost_ = !read;
    return read;
}

tl::expected<std::optional<Directive>, ParseError> DirectiveReader::directive() {
    const tl::expected<std::optional<Token>, ParseError> first = tokens_.next();
    if (!first) return tl::unexpected(first.error());
    if (!*first) return std::optional<Directive>{};
    Directive directive{.name = std::string((*first)->text), .where = (*first)->where};
    const Grammar* grammar = grammar_of(**first);
    if (std::ranges::count(kOfV2, directive.name) > 0)
        return tl::unexpected(ParseError{directive.where, quote(directive.name) + " is a directive of pbrt-v2", 2});
    if (grammar == nullptr || (grammar == &kWorldEnd && !is_v3_))
        return tl::unexpected(ParseError{directive.where,
                                         quote(directive.name) + " is not a directive of pbrt-v4" + near(directive.name, kGrammar),
                                         grammar == &kWorldEnd ? 3 : 4});

    for (int i = 0; i < grammar->strings; ++i) {
        const auto token = require(Token::Kind::kString, directive, "a quoted name");
        if (!token) return tl::unexpected(token.error());
        directive.strings.emplace_back(token->text);
    }
    if (grammar->optional_strings > 0 || grammar->word) {
        const auto token = tokens_.next();
        if (!token) return tl::unexpected(token.error());
        const bool fits = !ends_list(*token) &&
                          ((*token)->kind == Token::Kind::kString || (grammar->word && (*token)->kind == Token::Kind::kWord));
        if (fits) {
            directive.strings.emplace_back((*token)->text);
        } else {
            if (*token) tokens_.unget(**token);
            if (grammar->word)
                return tl::unexpected(ParseError{directive.where, fmt::format("{}: a word must follow", directive.name)});
        }
    }
    if (grammar->brackets) {
        if (const auto token = require(Token::Kind::kOpen, directive, "["); !token) return tl::unexpected(token.error());
    }
    for (int i = 0; i < grammar->numbers; ++i) {
        const auto value = number(directive);
        if (!value) return tl::unexpected(value.error());
        directive.numbers.push_back(*value);
    }
    if (grammar->brackets) {
        if (const auto token = require(Token::Kind::kClose, directive, "]"); !token) return tl::unexpected(token.error());
    }
    while (grammar->parameters) {
        auto one = parameter();
        if (!one) return tl::unexpected(one.error());
        if (!*one) break;
        directive.parameters.push_back(std::move(**one));
    }
    return directive;
}

tl::expected<std::optional<Parameter>, ParseError> DirectiveReader::parameter() {
    const auto declaration = tokens_.next();
    if (!declaration) return tl::unexpected(declaration.error());
    if (!*declaration) return std::optional<Parameter>{};
    if ((*declaration)->kind != Token::Kind::kString) {
        tokens_.unget(**declaration);
        return std::optional<Parameter>{};
    }
    Parameter parameter{.where = (*declaration)->where};
    const std::string_view text = (*declaration)->text;
    std::tie(parameter.type, parameter.name) = declaration_in(text);
    if (parameter.type.empty())
        return tl::unexpected(ParseError{parameter.where, quote(text) + " is not a parameter of the form \"type name\""});
    const std::string_view renamed = new_type(parameter.type);
    if (is_v3_ && !renamed.empty()) parameter.type = renamed;
    const TypeGrammar* const type = is_v3_ || renamed.empty() ? type_of(parameter.type) : nullptr;
    if (type == nullptr)
        return tl::unexpected(ParseError{parameter.where,
                                         quote(parameter.type) + " is not a parameter type" + near(parameter.type, kTypes),
                                         renamed.empty() ? 4 : 3});

    const auto add = [&](const Token& token) -> std::optional<ParseError> {
        const auto wrong = [&](std::string_view what) {
            return ParseError{token.where, fmt::format("{}: {} is not {}", parameter.name, quote(token.text), what)};
        };
        const bool is_quoted_flag = is_v3_ && type->values == ValueKind::kFlags && (token.text == "true" || token.text == "false");
        const bool is_string = token.kind == Token::Kind::kString && !is_quoted_flag;
        if (is_string && type->values < ValueKind::kStrings)
            return ParseError{token.where, fmt::format("{}: its type is {}, but {} is a string", parameter.name, parameter.type,
                                                       quote(token.text))};
        if (is_string && (type->values == ValueKind::kStrings || type->values == ValueKind::kNumbersOrStrings) &&
            parameter.numbers.empty()) {
            parameter.strings.emplace_back(token.text);
        } else if (type->values == ValueKind::kStrings) {
            return wrong("a quoted string");
        } else if (type->values == ValueKind::kFlags) {
            if (is_string || (token.text != "true" && token.text != "false")) return wrong("true or false");
            parameter.flags.push_back(token.text == "true");
        } else {
            const std::optional<double> value = is_string || !parameter.strings.empty() ? std::nullopt : parse_number(token.text);
            if (!value) return wrong("a finite number");
            if (parameter.type == "integer" && (*value != std::floor(*value) || std::abs(*value) > 2147483648.0))
                return wrong("a 32-bit integer");
            parameter.numbers.push_back(*value);
        }
        return std::nullopt;
    };
    auto token = tokens_.next();
    if (!token) return tl::unexpected(token.error());
    const bool next_parameter =
        *token && (*token)->kind == Token::Kind::kString && type->values < ValueKind::kStrings &&
        (type_of(declaration_in((*token)->text).first) != nullptr || !new_type(declaration_in((*token)->text).first).empty());
    if (ends_list(*token) || next_parameter) return tl::unexpected(missing(parameter.where, parameter.name, "a value", *token));
    if ((*token)->kind != Token::Kind::kOpen) {
        if ((*token)->kind == Token::Kind::kClose)
            return tl::unexpected(ParseError{(*token)->where, parameter.name + ": ] without ["});
        if (auto error = add(**token)) return tl::unexpected(*error);
        return parameter;
    }
    while (true) {
        token = tokens_.next();
        if (!token) return tl::unexpected(token.error());
        if (ends_list(*token)) return tl::unexpected(missing(parameter.where, parameter.name, "]", *token));
        if ((*token)->kind == Token::Kind::kClose) return parameter;
        if ((*token)->kind == Token::Kind::kOpen)
            return tl::unexpected(ParseError{(*token)->where, parameter.name + ": [ inside ["});
        if (auto error = add(**token)) return tl::unexpected(*error);
    }
}

}  // namespace latent::render
