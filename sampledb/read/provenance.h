// sampledb/read/provenance.h: what a file says of its origin: JSON that tools quote and copy, and never need to understand.
// docs/format.md, "Header" and "Footer".
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sampledb/read/file_reader.h"

namespace latent::sampledb {

inline constexpr std::size_t kHeaderProvenanceDepth = 32;  // levels that it may be nested
inline constexpr std::size_t kFooterProvenanceDepth = 64;

// JSON that can stand in a report or in another file's provenance.
struct QuotedProvenance {
    std::string json;       // the stored text; where that is not as docs/format.md asks, a string that begins like it
    std::string objection;  // what is wrong with it, as a clause: "is no JSON object"; empty: nothing
};

// `depth`: one of the two above.
QuotedProvenance quote_provenance(std::string_view stored, std::size_t depth);

// Gives `take` the JSON objects in which a file tells how its samples were made: that of its header, and those of the parts that
// were merged into it.
void for_each_origin(const FileContents& file, const std::function<void(std::string_view)>& take);

// What origins say, in the words of docs/format.md, "Registry". Each is empty where an origin does not say it.

// Pixels of the picture that the samples were counted for.
struct Resolution {
    std::uint32_t width, height;
};
std::optional<Resolution> resolution_in(std::string_view origin);

// Lights that records keep apart, in the order of their numbers. Lights without a name are called by their number.
struct NamedLights {
    std::string name;
    std::string spectrum;  // JSON; empty: they have different ones, or it is not known
};
std::vector<NamedLights> lights_in(std::string_view origin);

}  // namespace latent::sampledb
