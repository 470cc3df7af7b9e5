#include "render/load/model/append.h"

#include <iterator>
#include <limits>
#include <tuple>
#include <vector>

#include "render/scene/fields.h"

namespace latent::render {

namespace {

// Makes indices count from where the tables of `to` end.
class IndexShift : public FieldWalk<IndexShift> {
 public:
    explicit IndexShift(SceneDescription& to) : to_(to) {}

    template <class T>
    void change_index(std::uint32_t& i) {
        if (i != kNone) i += static_cast<std::uint32_t>(table<T>(to_).size());
    }
    template <class T>
    void change_number(T&) {}

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
