#include "render/scene/canonical.h"

#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "render/scene/content_hash.h"
#include "render/scene/fields.h"

namespace latent::render {

namespace {

// A table as it becomes.
template <class T>
struct Reordered {
    std::map<Hash128, std::uint32_t> index;  // where the entry with this content stands
    std::vector<T> entries;
};
template <class... Table>
std::tuple<Reordered<typename std::remove_reference_t<Table>::value_type>...> reordered(const std::tuple<Table...>&);

// Renumbers the indices, and turns -0 into 0.
class Canonical : public FieldWalk<Canonical> {
 public:
    Canonical(SceneDescription& scene, const ContentHashes& hashes) : scene_(scene), hashes_(hashes) {}

    // At the end: the tables become what was collected.
    void finish() {
        std::apply([this]<class... T>(Reordered<T>&... tables) { ((table<T>(scene_) = std::move(tables.entries)), ...); }, tables_);
    }

    template <class T>
    void change_number(T& x) {
        if (x == 0) x = 0;
    }
    // An entry moves when it is first met; its address still names its hash.
    template <class T>
    void change_index(std::uint32_t& i) {
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

 private:
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
