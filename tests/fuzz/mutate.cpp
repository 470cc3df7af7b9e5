#include "tests/fuzz/mutate.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <random>
#include <span>
#include <string_view>

namespace latent::fuzz {

namespace {

constexpr std::array<std::uint64_t, 14> kNumbers = {
    0, 1, 2, 255, 256, 4096, 6144, 65535, 65536, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x7FFFFFFFFFFFFFFF, ~std::uint64_t{0}};
constexpr std::array<std::string_view, 16> kTexts = {
    "0",   "-1", "1e38", "-1e308", "1e-320",     "nan", "inf", "4294967296",
    "0.5", "\"", "[",    "]",      "2147483648", "{",   ",",   "99999999999999999999"};

class Mutator {
 public:
    Mutator(Bytes& bytes, std::uint64_t seed) : bytes_(bytes), random_(seed) {}

    void change_bytes() {
        switch (below(6)) {
            case 0:  // a bit
                if (!bytes_.empty()) bytes_[place()] ^= std::byte{static_cast<unsigned char>(1u << below(8))};
                break;
            case 1:  // a number
                write_number();
                break;
            case 2:  // bytes of elsewhere, in place
                copy_within();
                break;
            case 3:  // bytes are gone
                erase(below(16) == 0 ? 4096 : 8);
                break;
            case 4:  // bytes of elsewhere, between
                insert_copy(below(16) == 0 ? 4096 : 8);
                break;
            default:  // the end is gone
                if (below(4) == 0) bytes_.resize(place());
        }
    }

    void change_text() {
        if (below(4) == 0) return change_bytes();
        const auto [begin, end] = word();
        const std::string_view other = below(2) == 0 ? kTexts[below(kTexts.size())] : other_word();
        const ByteSpan with = std::as_bytes(std::span(other));
        if (below(4) != 0) bytes_.erase(bytes_.begin() + begin, bytes_.begin() + end);
        bytes_.insert(bytes_.begin() + begin, with.begin(), with.end());
    }

    std::size_t below(std::size_t n) { return static_cast<std::size_t>(random_() % n); }

 private:
    std::size_t place() { return bytes_.empty() ? 0 : below(bytes_.size()); }

    void write_number() {
        const std::size_t width = std::size_t{1} << below(4);
        if (bytes_.size() < width) return;
        std::uint64_t value = kNumbers[below(kNumbers.size())];
        const std::size_t at = below(2) == 0 ? place() / width * width : place();
        if (at + width > bytes_.size()) return;
        if (below(2) == 0) {  // near what is there
            std::memcpy(&value, bytes_.data() + at, width);
            value += below(3) - 1;
        }
        std::memcpy(bytes_.data() + at, &value, width);
    }
    void copy_within() {
        if (bytes_.empty()) return;
        const std::size_t from = place(), to = place(), size = std::min(1 + below(64), bytes_.size() - std::max(from, to));
        std::memmove(bytes_.data() + to, bytes_.data() + from, size);
    }
    void erase(std::size_t most) {
        const std::size_t at = place(), size = std::min(1 + below(most), bytes_.size() - at);
        bytes_.erase(bytes_.begin() + static_cast<std::ptrdiff_t>(at), bytes_.begin() + static_cast<std::ptrdiff_t>(at + size));
    }
    void insert_copy(std::size_t most) {
        const std::size_t from = place(), to = place(), size = std::min(1 + below(most), bytes_.size() - from);
        const Bytes copy(bytes_.begin() + static_cast<std::ptrdiff_t>(from),
                         bytes_.begin() + static_cast<std::ptrdiff_t>(from + size));
        bytes_.insert(bytes_.begin() + static_cast<std::ptrdiff_t>(to), copy.begin(), copy.end());
    }

    bool in_word(std::size_t at) const {
        const auto c = static_cast<unsigned char>(bytes_[at]);
        return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '_' || c == '+';
    }
    // The word about some place: begin and end.
    std::pair<std::ptrdiff_t, std::ptrdiff_t> word() {
        std::size_t begin = place(), end = begin;
        while (begin > 0 && in_word(begin - 1)) --begin;
        while (end < bytes_.size() && in_word(end)) ++end;
        return {static_cast<std::ptrdiff_t>(begin), static_cast<std::ptrdiff_t>(end)};
    }
    std::string_view other_word() {
        const auto [begin, end] = word();
        copy_.assign(bytes_.begin() + begin, bytes_.begin() + end);
        return {reinterpret_cast<const char*>(copy_.data()), copy_.size()};
    }

    Bytes& bytes_;
    Bytes copy_;
    std::mt19937_64 random_;
};

}  // namespace

Bytes mutated(Bytes bytes, std::uint64_t seed, bool is_text) {
    Mutator mutator(bytes, seed);
    for (std::size_t changes = 1 + mutator.below(4); changes > 0; --changes) {
        if (is_text) {
            mutator.change_text();
        } else {
            mutator.change_bytes();
        }
    }
    return bytes;
}

}  // namespace latent::fuzz
