// base/hash.h: XXH3, the checksum of everything that is stored. Not cryptographic: it guards against accidents.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <memory>
#include <string>

#include "base/bytes.h"

namespace latent {

struct Hash128 {
    std::uint64_t low = 0;
    std::uint64_t high = 0;
    auto operator<=>(const Hash128&) const = default;
};

std::uint64_t hash64(ByteSpan bytes);
Hash128 hash128(ByteSpan bytes);

// 32 hexadecimal digits, most significant first.
std::string to_hex(const Hash128& hash);

// XXH3-64 of pieces that arrive one after another; equal to `hash64` of their concatenation.
class Hasher64 {
 public:
    Hasher64();
    ~Hasher64();
    void update(ByteSpan bytes);
    std::uint64_t digest() const;

 private:
    struct State;
    std::unique_ptr<State> state_;
};

// XXH3-128 of pieces that arrive one after another; equal to `hash128` of their concatenation.
class Hasher128 {
 public:
    Hasher128();
    ~Hasher128();
    void update(ByteSpan bytes);
    Hash128 digest() const;

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace latent
