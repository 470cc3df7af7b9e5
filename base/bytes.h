// base/bytes.h: little-endian integers and floats in byte arrays, whatever the host's own order.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace latent {

using Bytes = std::vector<std::byte>;
using ByteSpan = std::span<const std::byte>;

template <class T>
concept Number = std::is_arithmetic_v<T>;

template <Number T>
T load_le(const std::byte* from) {
    T value;
    if constexpr (std::endian::native == std::endian::little) {
        std::memcpy(&value, from, sizeof(T));
    } else {
        std::byte swapped[sizeof(T)];
        for (std::size_t i = 0; i < sizeof(T); ++i) swapped[i] = from[sizeof(T) - 1 - i];
        std::memcpy(&value, swapped, sizeof(T));
    }
    return value;
}

template <Number T>
void store_le(std::byte* to, T value) {
    std::memcpy(to, &value, sizeof(T));
    if constexpr (std::endian::native != std::endian::little) {
        for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(to[i], to[sizeof(T) - 1 - i]);
    }
}

// Appends fields one after another to a growing byte array.
class ByteWriter {
 public:
    explicit ByteWriter(Bytes& out) : out_(out) {}

    template <Number T>
    void put(T value) {
        const std::size_t at = out_.size();
        out_.resize(at + sizeof(T));
        store_le(out_.data() + at, value);
    }
    void put(ByteSpan bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }
    void put_zeros(std::size_t count) { out_.resize(out_.size() + count); }

 private:
    Bytes& out_;
};

// Takes fields off the front of a byte array. Reading past the end yields zeros and clears `ok()`: check it once, at the end.
class ByteReader {
 public:
    explicit ByteReader(ByteSpan bytes) : bytes_(bytes) {}

    template <Number T>
    T get() {
        const ByteSpan field = take(sizeof(T));
        return field.empty() ? T{} : load_le<T>(field.data());
    }
    ByteSpan take(std::size_t count) {
        if (count > bytes_.size() - at_) {
            ok_ = false;
            at_ = bytes_.size();
            return {};
        }
        at_ += count;
        return bytes_.subspan(at_ - count, count);
    }
    bool ok() const { return ok_; }
    std::size_t remaining() const { return bytes_.size() - at_; }
    std::size_t position() const { return at_; }

 private:
    ByteSpan bytes_;
    std::size_t at_ = 0;
    bool ok_ = true;
};

}  // namespace latent
