// sampledb/read/provenance.h: what a file says of its origin: JSON that tools quote and copy, and never need to understand.
// docs/format.md, "Header" and "Footer".
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

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

}  // namespace latent::sampledb
