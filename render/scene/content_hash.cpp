#include "render/scene/content_hash.h"

#include <array>
#include <bit>
#include <cassert>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "render/scene/fields.h"

namespace latent::render {

namespace {

// What is laid out in memory as its hash takes it: numbers in a row.
template <class T>
constexpr bool kIsFlat = std::is_arithmetic_v<T> && !std::is_same_v<T, bool>;
template <class T>
constexpr bool kIsFlat<Vec2<T>> = kIsFlat<T> && sizeof(Vec2<T>) == 2 * sizeof(T);
template <class T>
constexpr bool kIsFlat<Vec3<T>> = kIsFlat<T> && sizeof(Vec3<T>) == 3 * sizeof(T);

// -0 is 0, as in the canonical description.
template <class T>
T canonical(T x) {
    return x == 0 ? T{} : x;
}

// Feeds one hash with the fields that it visits.
class ContentHasher {
 public:
    ContentHasher(const SceneDescription& scene, std::unordered_map<const void*, Hash128>& known) : scene_(scene), known_(known) {}

    template <class... T>
    void operator()(const T&... x) {
        (put(x), ...);
    }
    template <class... T>
    void label(const T&...) {}
    template <class T, class... I>
    void index(const I&... i) {
        (put(i == kNone ? nullptr : &table<T>(scene_)[i]), ...);
    }
    Hash128 digest() const { return hash_.digest(); }

 private:
    template <class T>
    void put(const T& x) {
        if constexpr (std::is_enum_v<T>) {
            put(static_cast<std::uint64_t>(x));
        } else if constexpr (std::is_arithmetic_v<T>) {
            std::byte bytes[sizeof(T)];
            store_le(bytes, canonical(x));
            hash_.update(bytes);
        } else {
            each_field(x, *this);
        }
    }
    void put(const Hash128& hash) {
        put(hash.low);
        put(hash.high);
    }
    void put(const color::Spectrum& s) {
        put_range(s.lambda_nm());
        put_range(s.values());
        put(s.outside());
    }
    void put(const std::string& text) { put_range(std::span(text)); }
    template <class T>
    void put(const std::vector<T>& items) {
        if constexpr (std::is_same_v<T, bool>) {
            put(items.size());
            for (const bool x : items) put(x);
        } else {
            put_range(std::span(items));
        }
    }
    template <class T, std::size_t N>
    void put(const std::array<T, N>& items) {
        put_range(std::span(items));
    }
    template <class T>
    void put(const std::map<std::string, T, std::less<>>& items) {
        put(std::uint64_t{items.size()});
        for (const auto& [name, x] : items) put(name), put(x);
    }
    template <class T>
    void put(const std::optional<T>& x) {
        put(x.has_value());
        if (x) put(*x);
    }
    template <class... T>
    void put(const std::variant<T...>& x) {
        put(x.index());
        std::visit([this](const auto& value) { this->put(value); }, x);
    }
    template <class T>
    void put(const std::shared_ptr<T>& x) {
        put(x.get());
    }
    // By the hash of its content, which is computed once however often it is referred to.
    template <class T>
    void put(const T* x) {
        put(x != nullptr);
        if (x == nullptr) return;
        const auto found = known_.find(x);
        if (found != known_.end()) return put(found->second);
        ContentHasher inner(scene_, known_);
        inner.put(*x);
        put(known_.emplace(x, inner.digest()).first->second);
    }
    template <class Span>
    void put_range(const Span& items) {
        put(std::uint64_t{items.size()});
        if constexpr (kIsFlat<typename Span::value_type> && std::endian::native == std::endian::little) {
            hash_.update(std::as_bytes(items));
        } else {
            for (const auto& x : items) put(x);
        }
    }

    const SceneDescription& scene_;
    std::unordered_map<const void*, Hash128>& known_;
    Hasher128 hash_;
};

}  // namespace

ContentHashes content_hashes(const SceneDescription& scene) {
    ContentHashes hashes;
    ContentHasher whole(scene, hashes.entries);
    each_field(scene, whole);
    hashes.scene = whole.digest();
    return hashes;
}

}  // namespace latent::render
