// base/json.h: JSON to and from text. Compiled once: nlohmann's reader and writer are most of what it costs to use it.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "base/result.h"

namespace latent {

// Bytes that are no UTF-8, as the name of a file may hold, become U+FFFD; nlohmann would throw. Characters that steer terminals
// are escaped. `indent` -1: all in one line.
std::string json_text(const nlohmann::json& value, int indent = 2);
std::string json_text(const nlohmann::ordered_json& value, int indent = 2);

// Appends JSON text with DEL and U+0080 .. U+009F escaped, which JSON allows raw and terminals obey.
void append_escaped(std::string& text, std::string_view json);

// `object`, as json_text writes it with an indent, with one more member; `put_value` appends its value, JSON text of any length.
std::string with_member(std::string object, std::string_view name, const std::function<void(std::string&)>& put_value);

// Whether `text` is a JSON object nested at most `max_depth` deep; takes memory for its longest string only.
// Errors: kCorrupt, saying why.
Status check_json_object(std::string_view text, std::size_t max_depth);

// Parts of a text that check_json_object accepts, as they stand there: the value of a member of the outermost object, empty if
// there is none; all its members, none if it is no object, names without quotation marks; the elements of an array, none if it is
// no array.
std::string_view member_of(std::string_view object, std::string_view name);
void for_each_member(std::string_view object, const std::function<void(std::string_view name, std::string_view value)>& take);
void for_each_element(std::string_view array, const std::function<void(std::string_view)>& take);

}  // namespace latent
