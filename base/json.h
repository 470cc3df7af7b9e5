// base/json.h: JSON to and from text. Compiled once: nlohmann's reader and writer are most of what it costs to use it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace latent {

// Bytes that are no UTF-8, as the name of a file may hold, become U+FFFD; nlohmann would throw. `indent` -1: all in one line.
std::string json_text(const nlohmann::json& value, int indent = 2);
std::string json_text(const nlohmann::ordered_json& value, int indent = 2);

// What a text says in JSON; anything else is kept as text; nothing is an empty object.
nlohmann::json json_or_text(const std::string& text);

}  // namespace latent
