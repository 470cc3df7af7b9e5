#include "render/load/model/append.h"

#include <array>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <variant>

#include "render/scene/fields.h"

namespace latent::render {

namespace {

// Visits fields, and makes the indices among them count from where the tables of `to` end.
class IndexShift {
 public:
    explicit IndexShift(SceneDescription& to) : to_(to) {}

    template <class... T>
    void operator()(T&... x) {
        (go_into(x), ...);
    }
    template <class... T>
    void label(const T&...) {}
    template <class T, class... I>
    void index(I&... i) {
        ((i += i == kNone ? 0 : static_cast<std::uint32_t>(table<T>(to_).size())), ...);
    }
    template <class T>
    void go_into(T& x) {
        if constexpr (Listed<T, IndexShift>) each_field(x, *this);
    }
    template <class T>
    void go_into(std::vector<T>& items) {
        if constexpr (Listed<T, IndexShift>) {
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
    template <class T>
    void go_into(std::shared_ptr<const T>&) {}  // holds no indices

 private:
    SceneDescription& to_;
};

template <class T>
void move_behind(std::vector<T>& from, std::vector<T>& to) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

}  // namespace

void append(Model more, Model& model) {
    SceneDescription &from = more.scene, &to = model.scene;
    IndexShift shift(to);
    std::apply([&](auto&... tables) { (shift.go_into(tables), ...); }, tables(from));
    shift.go_into(from.camera);
    shift.go_into(from.lights);
    shift.go_into(from.instances);
    for (LoadedShape& loaded : more.shapes) shift.go_into(loaded.shape);
    for (std::vector<LoadedShape>& shapes : more.objects) {
        for (LoadedShape& loaded : shapes) shift.go_into(loaded.shape);
    }

    model.radiances.resize(to.area_lights.size(), std::numeric_limits<double>::infinity());
    more.radiances.resize(from.area_lights.size(), std::numeric_limits<double>::infinity());
    move_behind(more.radiances, model.radiances);
    move_behind(from.textures, to.textures);
    move_behind(from.materials, to.materials);
    move_behind(from.media, to.media);
    move_behind(from.area_lights, to.area_lights);
    move_behind(from.objects, to.objects);
    move_behind(from.lights, to.lights);
    move_behind(from.instances, to.instances);
    move_behind(more.shapes, model.shapes);
    move_behind(more.objects, model.objects);
    if (more.has_camera) {
        to.camera = from.camera;
        to.film = from.film;
        to.shutter = from.shutter;
        model.has_camera = true;
    }
    if (more.has_integrator) {
        to.integrator = from.integrator;
        to.max_depth = from.max_depth;
    } else if (from.max_depth == kUnlimited) {  // light scatters very often in what was added
        to.max_depth = kUnlimited;
    }
}

}  // namespace latent::render
