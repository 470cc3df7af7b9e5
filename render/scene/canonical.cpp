#include "render/scene/canonical.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "render/scene/content_hash.h"
#include "render/scene/fields.h"

namespace latent::render {

namespace {

// A table as it becomes.
template <class T>
struct Reordered {
    std::map<Hash128, std::uint32_t> index;  // of the entry with this content
    std::vector<T> entries;
};
template <class... Table>
std::tuple<Reordered<typename std::remove_reference_t<Table>::value_type>...> reordered(const std::tuple<Table...>&);

// Visits fields, renumbers the indices among them, and turns -0 into 0.
class Canonical {
 public:
    Canonical(SceneDescription& scene, const ContentHashes& hashes) : scene_(scene), hashes_(hashes) {}

    template <class... T>
    void operator()(T&... x) {
        (go_into(x), ...);
    }
    template <class... T>
    void label(const T&...) {}
    template <class T, class... I>
    void index(I&... i) {
        (renumber<T>(i), ...);
    }
    // At the end: the tables become what was collected.
    void finish() {
        std::apply([this]<class... T>(Reordered<T>&... tables) { ((table<T>(scene_) = std::move(tables.entries)), ...); }, tables_);
    }

 private:
    // An entry moves when it is first met; its address still names its hash.
    template <class T>
    void renumber(std::uint32_t& i) {
        if (i == kNone) return;
        Reordered<T>& to = std::get<Reordered<T>>(tables_);
        T& entry = table<T>(scene_)[i];
        const auto [known, is_new] =
            to.index.try_emplace(hashes_.entries.at(&entry), static_cast<std::uint32_t>(to.entries.size()));
        i = known->second;
        if (!is_new) return;
        to.entries.push_back(std::move(entry));
        T moved = std::move(to.entries[i]);  // outside: entries that it refers to may be of the same table
        go_into(moved);
        to.entries[i] = std::move(moved);
    }
    template <class T>
    void go_into(T& x) {
        if constexpr (std::is_floating_point_v<T>) {
            if (x == 0) x = 0;
        } else if constexpr (Listed<T, Canonical>) {
            each_field(x, *this);
        }
    }
    template <class T>
    void go_into(std::vector<T>& items) {
        if constexpr (Listed<T, Canonical>) {
            for (T& x : items) go_into(x);
        }
    }
    template <class T, std::size_t N>
    void go_into(std::array<T, N>& items) {
        for (T& x : items) go_into(x);
    }
    template <class T>
    void go_into(std::map<std::string, T, std::less<>>& items) {
        for (auto& [name, x] : items) go_into(x);
    }
    template <class T>
    void go_into(std::optional<T>& x) {
        if (x) go_into(*x);
    }
    template <class... T>
    void go_into(std::variant<T...>& x) {
        std::visit([this](auto& value) { this->go_into(value); }, x);
    }
    // What is shared is shared between scenes too: it stays as it is, and holds no indices.
    template <class T>
    void go_into(std::shared_ptr<const T>&) {}

    SceneDescription& scene_;
    const ContentHashes& hashes_;
    decltype(reordered(tables(std::declval<SceneDescription&>()))) tables_;
};

}  // namespace

Hash128 make_canonical(SceneDescription& scene) {
    const ContentHashes hashes = content_hashes(scene);
    Canonical canonical(scene, hashes);
    each_field(scene, canonical);
    canonical.finish();
    return hashes.scene;
}

}  // namespace latent::render
