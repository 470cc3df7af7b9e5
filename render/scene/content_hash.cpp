#include "render/scene/content_hash.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

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

// Numbers in a row, of which all count.
template <class T>
constexpr bool kIsPlace = Of<T, Affinef> || Of<T, Affined>;
template <class T>
constexpr bool kIsPlace<Vec2<T>> = true;
template <class T>
constexpr bool kIsPlace<Vec3<T>> = true;

template <class T>
const T kDefault{};

// -0 is 0, as in the canonical description.
template <class T>
T canonical(T x) {
    return x == 0 ? T{} : x;
}

// Writes values one after the other, for a hash of them all. A struct is written as the numbers and values of those of its fields
// that differ from a default one's: a scene keeps its hash when a struct gets a field that it does not use.
class ContentWriter {
 public:
    ContentWriter(const SceneDescription& scene, std::unordered_map<const void*, Hash128>& known) : scene_(scene), known_(known) {}

    template <class T>
    void put(const T& x) {
        if constexpr (std::is_enum_v<T>) {
            put(static_cast<std::uint64_t>(x));
        } else if constexpr (std::is_arithmetic_v<T>) {
            std::byte bytes[sizeof(T)];
            store_le(bytes, canonical(x));
            bytes_.insert(bytes_.end(), std::begin(bytes), std::end(bytes));
        } else if constexpr (kIsPlace<T>) {
            each_field(x, [this](const auto&... coordinates) { (this->put(coordinates), ...); });
        } else {
            put_fields(x);
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
        const std::size_t begin = bytes_.size();
        put(*x);
        put(known_.emplace(x, take_from(begin)).first->second);
    }
    // Forgets what was written from `begin` on; its hash.
    Hash128 take_from(std::size_t begin) {
        const Hash128 hash = hash128(std::span(bytes_).subspan(begin));
        bytes_.resize(begin);
        return hash;
    }

 private:
    using Fields = std::vector<Bytes>;

    // Visits the fields of a struct, and calls back with each of those that count.
    template <class Take>
    struct EachField {
        const SceneDescription& scene;
        Take take;

        template <class... T>
        void operator()(const T&... x) {
            (take(x), ...);
        }
        template <class... T>
        void label(const T&...) {}
        template <class T, class... I>
        void index(const I&... i) {
            (take(i == kNone ? static_cast<const T*>(nullptr) : &table<T>(scene)[i]), ...);
        }
    };
    template <class Take>
    EachField(const SceneDescription&, Take) -> EachField<Take>;

    template <class T>
    const Fields& default_fields() {
        static const Fields fields = [this] {
            Fields all;
            EachField each{scene_, [&](const auto& value) {
                               ContentWriter writer(scene_, known_);
                               writer.put(value);
                               all.push_back(std::move(writer.bytes_));
                           }};
            each_field(std::as_const(kDefault<T>), each);
            return all;
        }();
        return fields;
    }
    template <class T>
    void put_fields(const T& x) {
        constexpr std::uint8_t kEnd = 255;
        const Fields& defaults = default_fields<T>();
        std::uint8_t number = 0;
        EachField each{scene_, [&](const auto& value) {
                           const std::size_t begin = bytes_.size();
                           put(number);
                           put(value);
                           if (std::ranges::equal(std::span(bytes_).subspan(begin + 1), defaults[number])) bytes_.resize(begin);
                           ++number;
                       }};
        each_field(x, each);
        put(kEnd);
    }
    // By the hash of its items, so that little is held at a time.
    template <class Span>
    void put_range(const Span& items) {
        put(std::uint64_t{items.size()});
        if constexpr (kIsFlat<typename Span::value_type> && std::endian::native == std::endian::little) {
            put(hash128(std::as_bytes(items)));
        } else {
            Hasher128 all;
            const std::size_t begin = bytes_.size();
            for (const auto& x : items) {
                put(x);
                all.update(std::span(bytes_).subspan(begin));
                bytes_.resize(begin);
            }
            put(all.digest());
        }
    }

    const SceneDescription& scene_;
    std::unordered_map<const void*, Hash128>& known_;
    Bytes bytes_;
};

}  // namespace

ContentHashes content_hashes(const SceneDescription& scene) {
    ContentHashes hashes;
    ContentWriter whole(scene, hashes.entries);
    whole.put(scene);
    hashes.scene = whole.take_from(0);
    return hashes;
}

}  // namespace latent::render
