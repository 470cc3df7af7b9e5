// Scenes, from their text to a few samples.
#include "render/load/mesh/ply.h"
#include "render/program/job.h"
#include "tests/faults/process.h"
#include "tests/fuzz/target.h"
#include "tests/support/paths.h"
#include "tests/transport/measured_examples.h"

namespace latent::fuzz {

namespace {

// What a scene may name.
void write_companions() {
    static const bool written = [] {
        const auto put = [](const char* name, std::string_view text) { as_file(name, std::as_bytes(std::span(text))); };
        put("m.ply",
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0.2\n0 1 0\n4 0 1 2 3\n");
        put("s.spd", "400 1 500 2 600 3 700 1\n");
        put("i.pbrt", "Shape \"sphere\" \"float radius\" 0.5\n");
        put("p.png", testing::read_text(testing::in_tree("tests/fuzz/seeds/picture/a.png")));
        put("q.tif", testing::read_text(testing::in_tree("tests/fuzz/seeds/picture/mips.tif")));  // as wide as high
        as_file("m.bsdf", render::testing::MeasuredFile(render::testing::measured({.side = 4, .directions = 2})).bytes());
        return true;
    }();
    (void)written;
}

bool render(const std::filesystem::path& scene, std::size_t choice) {
    using namespace latent::render;
    write_companions();
    RenderSettings settings;
    settings.scene = scene;
    settings.spp = 1;
    settings.resolution = Resolution{4, 4};
    settings.record = (choice & 1) != 0 ? sampledb::RecordKind::kXyz : sampledb::RecordKind::kSpectral;
    settings.integrator = (choice & 2) != 0 ? IntegratorKind::kBdpt : IntegratorKind::kPath;
    settings.connections = (choice & 4) != 0 ? Connections::kAll : Connections::kOne;
    settings.light_groups = (choice & 8) != 0;
    settings.max_depth = 4;
    auto job = prepare(settings);
    if (!job && settings.light_groups) {  // lights may have no names
        settings.light_groups = false;
        job = prepare(settings);
    }
    if (!job) return false;
    sampledb::Records records;
    RadianceFaults faults;
    for (std::uint64_t n = 0; n < 4; ++n) (*job)->integrator->trace(n, records, faults);
    return true;
}

bool run_pbrt(ByteSpan bytes) { return render(as_file("a.pbrt", bytes), bytes.size()); }

bool run_gltf(ByteSpan bytes) {
    return render(as_file(text_of(bytes).starts_with("glTF") ? "a.glb" : "a.gltf", bytes), bytes.size());
}

// What follows a line of equals signs is a.mtl.
bool run_obj(ByteSpan bytes) {
    const std::string_view text = text_of(bytes);
    constexpr std::string_view kLine = "====\n";
    const std::size_t obj = std::min(text.find(kLine), text.size()), mtl = std::min(obj + kLine.size(), text.size());
    as_file("a.mtl", bytes.subspan(mtl));
    return render(as_file("a.obj", bytes.first(obj)), bytes.size());
}

bool run_ply(ByteSpan bytes) {
    const Result<latent::render::PlyMesh> mesh = latent::render::parse_ply(text_of(bytes), "m.ply");
    if (!mesh) return false;
    const auto inside = [&](const std::vector<std::uint32_t>& indices) {
        for (const std::uint32_t i : indices) require(i < mesh->positions.size(), "indices are those of vertices");
    };
    inside(mesh->triangles), inside(mesh->quads);
    const auto fits = [&](std::size_t size) { return size == 0 || size == mesh->positions.size(); };
    require(fits(mesh->normals.size()) && fits(mesh->uvs.size()), "every vertex has what some have");
    return true;
}

}  // namespace

Target pbrt() { return {"pbrt", run_pbrt, nullptr, true, 1500, nullptr}; }
Target gltf() { return {"gltf", run_gltf, nullptr, true, 1500, nullptr}; }
Target obj() { return {"obj", run_obj, nullptr, true, 1500, nullptr}; }
Target ply() { return {"ply", run_ply, nullptr, true, 15000, nullptr}; }

}  // namespace latent::fuzz
