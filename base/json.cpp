#include "base/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace latent {

namespace {

template <class Json>
std::string text_of(const Json& value, int indent) {
    std::string text;
    append_escaped(text, value.dump(indent, ' ', false, Json::error_handler_t::replace));
    return text;
}

// Follows the reader without keeping anything; false ends it.
class DepthCheck {
 public:
    explicit DepthCheck(std::size_t max_depth) : max_depth_(max_depth) {}
    bool too_deep() const { return depth_ > max_depth_; }

    bool null() { return true; }
    bool boolean(bool) { return true; }
    bool number_integer(std::int64_t) { return true; }
    bool number_unsigned(std::uint64_t) { return true; }
    bool number_float(double, const std::string&) { return true; }
    bool string(std::string&) { return true; }
    bool binary(nlohmann::json::binary_t&) { return true; }
    bool key(std::string&) { return true; }
    bool start_object(std::size_t) { return ++depth_ <= max_depth_; }
    bool start_array(std::size_t) { return ++depth_ <= max_depth_; }
    bool end_object() { return --depth_, true; }
    bool end_array() { return --depth_, true; }
    bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception&) { return false; }

 private:
    const std::size_t max_depth_;
    std::size_t depth_ = 0;
};

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

// Walks over JSON that is known to be good.
class Scanner {
 public:
    explicit Scanner(std::string_view text) : text_(text) {}

    bool take(char c) {
        skip_space();
        if (at_ == text_.size() || text_[at_] != c) return false;
        ++at_;
        return true;
    }
    std::string_view value() {
        skip_space();
        const std::size_t begin = at_;
        std::size_t depth = 0;
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (depth == 0 && (c == ',' || c == ':' || c == ']' || c == '}' || is_space(c))) break;
            if (c == '"') {
                skip_string();
            } else {
                if (c == '[' || c == '{') ++depth;
                if (c == ']' || c == '}') --depth;
                ++at_;
            }
            if (depth == 0 && (c == '"' || c == ']' || c == '}')) break;
        }
        return text_.substr(begin, at_ - begin);
    }

 private:
    void skip_space() {
        while (at_ < text_.size() && is_space(text_[at_])) ++at_;
    }
    void skip_string() {
        for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) at_ += text_[at_] == '\\' ? 1 : 0;
        ++at_;
    }

    const std::string_view text_;
    std::size_t at_ = 0;
};

}  // namespace

std::string json_text(const nlohmann::json& value, int indent) { return text_of(value, indent); }
std::string json_text(const nlohmann::ordered_json& value, int indent) { return text_of(value, indent); }

void append_escaped(std::string& text, std::string_view json) {
    const auto to_escape = std::ranges::count_if(json, [](char c) { return c == '\x7f' || c == '\xc2'; });
    text.reserve(text.size() + json.size() + 5 * static_cast<std::size_t>(to_escape) + 16);  // with what ends an object
    for (std::size_t at = 0; at < json.size();) {
        const std::size_t next = std::min(json.find_first_of("\x7f\xc2", at), json.size());
        text += json.substr(at, next - at);
        at = next;
        if (at == json.size()) break;
        const bool two_bytes = json[at] == '\xc2' && at + 1 < json.size();
        const unsigned code = two_bytes ? static_cast<unsigned char>(json[at + 1]) : 0x7f;
        const std::size_t length = two_bytes ? 2 : 1;
        if (code < 0xa0) {
            fmt::format_to(std::back_inserter(text), "\\u{:04x}", code);
        } else {
            text += json.substr(at, length);
        }
        at += length;
    }
}

std::string with_member(std::string object, std::string_view name, const std::function<void(std::string&)>& put_value) {
    object.resize(object.rfind('}') - 1);  // and the line break before it
    fmt::format_to(std::back_inserter(object), ",\n  \"{}\": ", name);
    put_value(object);
    object += "\n}";
    return object;
}

Status check_json_object(std::string_view text, std::size_t max_depth) {
    const auto first = std::ranges::find_if_not(text, is_space);
    if (first == text.end() || *first != '{') return Error{ErrorCode::kCorrupt, "is not a JSON object"};
    DepthCheck check(max_depth);
    if (nlohmann::json::sax_parse(text.begin(), text.end(), &check)) return {};
    if (check.too_deep()) return Error{ErrorCode::kCorrupt, fmt::format("is nested more than {} levels deep", max_depth)};
    return Error{ErrorCode::kCorrupt, "is not valid JSON"};
}

void for_each_member(std::string_view object, const std::function<void(std::string_view, std::string_view)>& take) {
    Scanner in(object);
    if (!in.take('{') || in.take('}')) return;
    do {
        const std::string_view name = in.value();
        in.take(':');
        take(name.substr(1, name.size() - 2), in.value());
    } while (in.take(','));
}

std::string_view member_of(std::string_view object, std::string_view name) {
    std::string_view found;
    for_each_member(object, [&](std::string_view key, std::string_view value) {
        if (found.empty() && key == name) found = value;
    });
    return found;
}

void for_each_element(std::string_view array, const std::function<void(std::string_view)>& take) {
    Scanner in(array);
    if (!in.take('[') || in.take(']')) return;
    do take(in.value());
    while (in.take(','));
}

}  // namespace latent
