#include "render/scene/shape_counts.h"

namespace latent::render {

namespace {

ShapeCounts count(const std::vector<ShapeDescription>& shapes) {
    ShapeCounts out;
    for (const ShapeDescription& shape : shapes) {
        if (shape.kind == ShapeKind::kTriangles) {
            out.triangles += shape.mesh->indices.size() / 3;
        } else if (shape.kind == ShapeKind::kBilinear) {
            out.patches += shape.mesh->indices.size() / 4;
        } else if (shape.kind == ShapeKind::kTube) {
            out.curve_segments += shape.mesh->indices.size();
        } else {
            ++out.quadrics;
        }
    }
    return out;
}

void add(ShapeCounts& sum, const ShapeCounts& more) {
    sum.triangles += more.triangles;
    sum.patches += more.patches;
    sum.curve_segments += more.curve_segments;
    sum.quadrics += more.quadrics;
}

}  // namespace

SceneSize size_of(const SceneDescription& scene) {
    const ShapeCounts single = count(scene.shapes);
    SceneSize out{.stored = single, .placed = single, .instances = scene.instances.size()};
    std::vector<ShapeCounts> objects;
    for (const ObjectDescription& object : scene.objects) add(out.stored, objects.emplace_back(count(object.shapes)));
    for (const InstanceDescription& instance : scene.instances) add(out.placed, objects[instance.object]);
    return out;
}

}  // namespace latent::render
