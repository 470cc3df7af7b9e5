// base/json.h: JSON to and from text.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace latent {

// Bytes that are no UTF-8, as the name of a file may hold, become U+FFFD; nlohmann would throw. `indent` -1: all in one line.
template <class Json>
std::string json_text(const Json& value, int indent = 2) {
    return value.dump(indent, ' ', false, Json::error_handler_t::replace);
}

// What a text says in JSON; anything else is kept as text; nothing is an empty object.
inline nlohmann::json json_or_text(const std::string& text) {
    if (text.empty()) return nlohmann::json::object();
    nlohmann::json value = nlohmann::json::parse(text, nullptr, false);
    return value.is_discarded() ? nlohmann::json(text) : value;
}

}  // namespace latent
