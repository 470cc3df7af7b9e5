// Lines of sight against brute force: the crossings with every shape of a scene, sorted and counted.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <utility>

#include "tests/render/built_geometry.h"

namespace latent::render {
namespace {

using testing::build;
using testing::Built;
using testing::Random;

// Where a line hits a shape, and the media on the two sides.
struct Event {
    double t;
    std::uint32_t left, entered;
};

// Shapes in the cells of a lattice, whose faces, edges and corners they share. All are between media but the sheets, which are
// solid.
class Lattice {
 public:
    explicit Lattice(Random& random) {
        const auto medium = [&] { return static_cast<std::uint32_t>(random(0, 2.999f)); };
        for (int i = 0; i < 27; ++i) {
            const Vec3d low(i % 3, i / 3 % 3, i / 9);
            if (random(0, 1) < 0.3f) continue;
            const std::uint32_t cell = medium(), inner = medium();
            boxes_.push_back({low, low + Vec3d{1, 1, 1}, cell, kNone});
            if (inner == cell) continue;
            const int what = static_cast<int>(random(0, 3.999f));
            const auto size = [&] { return random(0, 1) < 0.5f ? 0.5 : 1.0; };
            const double x = size(), y = size(), z = size();
            if (what == 0) boxes_.push_back({low, low + Vec3d{x, y, z}, inner, cell});
            if (what == 1) balls_.push_back({low + Vec3d{.5, .5, .5}, inner, cell});
            if (what == 2) tubes_.push_back({low + Vec3d{.5, .5, 0}, inner, cell});
        }
        for (int i = 0; i < 6; ++i) {
            const auto on_lattice = [&](float end) { return std::floor(static_cast<double>(random(0, end))); };
            const int axis = i % 3;
            Vec3d low(on_lattice(2.999f), on_lattice(2.999f), on_lattice(2.999f));
            component(low, axis) = on_lattice(3.999f);
            sheets_.push_back({low, axis});
        }
    }

    std::string text() const {
        std::string text;
        for (const Sheet& s : sheets_) {
            const Vec3d e1 = unit((s.axis + 1) % 3), e2 = unit((s.axis + 2) % 3);
            text += "Shape \"bilinearmesh\" \"point3 P\" [" + points({s.low, s.low + e1, s.low + e2, s.low + e1 + e2}) + "]\n";
        }
        text += "Material \"interface\"\n";
        for (const Box& b : boxes_) {
            const Vec3d &l = b.low, &h = b.high;
            text +=
                media(b.inside, b.outside) + "Shape \"trianglemesh\" \"point3 P\" [" +
                points(
                    {l, {l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, l.y, l.z}, {l.x, h.y, l.z}, {l.x, h.y, h.z}, h, {h.x, h.y, l.z}}) +
                "] \"integer indices\" [0 2 1 0 3 2  4 5 6 4 6 7  0 1 5 0 5 4  3 6 2 3 7 6  1 2 6 1 6 5  0 4 7 0 7 3]\n";
        }
        for (const Ball& b : balls_) {
            text += media(b.inside, b.outside) + "AttributeBegin\n" +
                    fmt::format("Translate {} {} {}\nShape \"sphere\" \"float radius\" .5\nAttributeEnd\n", b.center.x, b.center.y,
                                b.center.z);
        }
        for (const Ball& b : tubes_) {
            const auto at = [&](double z) { return b.center + Vec3d{0, 0, z}; };
            text += media(b.inside, b.outside) + "Shape \"curve\" \"string type\" \"cylinder\" \"float width\" .6 \"point3 P\" [" +
                    points({at(.1), at(.1 + .8 / 3), at(.9 - .8 / 3), at(.9)}) + "]\n";
        }
        return text;
    }

    // Where the line hits interfaces, in order, and the first sheet, if there is one. False: it runs too nearly along a face,
    // comes too near to an edge of a sheet, or passes the open end of a tube, to say what it hits.
    bool meet(const Vec3d& o, const Vec3d& d, std::vector<Event>& events, double& sheet) const {
        if (std::min({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) < 0.05) return false;
        const auto add = [&](double in, double out, std::uint32_t inside, std::uint32_t outside) {
            events.push_back({in, outside, inside});
            events.push_back({out, inside, outside});
        };
        for (const Box& b : boxes_) {
            double in = -kInfinity, out = kInfinity;
            for (int k = 0; k < 3; ++k) {
                const double a = (component(b.low, k) - component(o, k)) / component(d, k),
                             c = (component(b.high, k) - component(o, k)) / component(d, k);
                in = std::max(in, std::min(a, c));
                out = std::min(out, std::max(a, c));
            }
            if (in < out) add(in, out, b.inside, b.outside);
        }
        for (const Ball& b : balls_) {
            const Vec3d to = b.center - o;
            const double middle = dot(to, d) / dot(d, d), inside = .25 - length_squared(to - d * middle);
            const double half = std::sqrt(std::max(0.0, inside) / dot(d, d));
            if (half > 0) add(middle - half, middle + half, b.inside, b.outside);
        }
        for (const Ball& b : tubes_) {
            const Vec3d to{b.center.x - o.x, b.center.y - o.y, 0}, along{d.x, d.y, 0};
            const double middle = dot(to, along) / dot(along, along), inside = .09 - length_squared(to - along * middle);
            if (!(inside > 0)) continue;
            const double half = std::sqrt(inside / dot(along, along));
            for (const double t : {middle - half, middle + half}) {
                const double z = o.z + d.z * t - b.center.z;
                if (z < .1 || z > .9) return false;
                events.push_back(t < middle ? Event{t, b.outside, b.inside} : Event{t, b.inside, b.outside});
            }
        }
        std::ranges::sort(events, {}, &Event::t);
        sheet = kInfinity;
        for (const Sheet& s : sheets_) {
            const double t = (component(s.low, s.axis) - component(o, s.axis)) / component(d, s.axis);
            double room = kInfinity;  // to the nearest edge; negative: outside
            for (const int k : {(s.axis + 1) % 3, (s.axis + 2) % 3}) {
                const double x = component(o, k) + component(d, k) * t - component(s.low, k);
                room = std::min({room, x, 1 - x});
            }
            if (std::abs(room) < 1e-4) return false;
            if (room > 0) sheet = std::min(sheet, t);
        }
        return true;
    }

 private:
    struct Box {
        Vec3d low, high;
        std::uint32_t inside, outside;
    };
    struct Ball {  // or a tube, from the centre of its cell's floor
        Vec3d center;
        std::uint32_t inside, outside;
    };
    struct Sheet {
        Vec3d low;
        int axis;
    };

    static double& component(Vec3d& v, int k) { return k == 0 ? v.x : k == 1 ? v.y : v.z; }
    static double component(const Vec3d& v, int k) { return k == 0 ? v.x : k == 1 ? v.y : v.z; }
    static Vec3d unit(int k) { return {k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0}; }
    static std::string points(std::initializer_list<Vec3d> list) {
        std::string text;
        for (const Vec3d& p : list) text += fmt::format("{:.17g} {:.17g} {:.17g}  ", p.x, p.y, p.z);
        return text;
    }
    static std::string media(std::uint32_t inside, std::uint32_t outside) {
        const auto name = [](std::uint32_t medium) { return medium == kNone ? "" : fmt::format("{}", medium); };
        return fmt::format("MediumInterface \"{}\" \"{}\"\n", name(inside), name(outside));
    }

    std::vector<Box> boxes_;
    std::vector<Ball> balls_, tubes_;
    std::vector<Sheet> sheets_;
};

// Media by how often the line has entered them, less how often it has left them.
class Count {
 public:
    void cross(const Event& event) { --count_[event.left], ++count_[event.entered]; }
    // Where one is counted once and no other; else, several surfaces are being crossed.
    std::optional<std::uint32_t> medium() const {
        std::optional<std::uint32_t> one;
        for (const auto& [medium, count] : count_) {
            if (count == 0) continue;
            if (count != 1 || one) return std::nullopt;
            one = medium;
        }
        return one;
    }

 private:
    std::map<std::uint32_t, int> count_{{kNone, 1}};
};

std::uint32_t medium_at(const Line& line, double t) {
    std::uint32_t medium = kNone;
    for (const Crossing& crossing : line.crossings) {
        if (crossing.t < t) medium = crossing.entered;
    }
    return medium;
}

// A way to place shapes in the world.
struct Way {
    std::string before, after;
    bool moves = false;
};

TEST(Lines, AreTheCrossingsWithAllShapesSortedAndCounted) {
    constexpr double kNear = 0.005;  // what is thinner may count as nothing
    // An orthonormal frame, in a place where no coordinate is exact.
    const Vec3d ex = normalize(Vec3d{3, 1, -2}), ez = normalize(cross(ex, Vec3d{1, 5, 2})), ey = cross(ez, ex),
                at{1.23, -4.56, .789};
    const auto in_world = [&](const Vec3d& v) { return ex * v.x + ey * v.y + ez * v.z; };
    const Vec3d velocity{.3, -.2, .4};
    std::string media;
    for (int i = 0; i < 3; ++i) media += fmt::format("MakeNamedMedium \"{}\" \"string type\" \"homogeneous\"\n", i);
    const std::string place = fmt::format("Transform [{} {} {} 0  {} {} {} 0  {} {} {} 0  {} {} {} 1]\n", ex.x, ex.y, ex.z, ey.x,
                                          ey.y, ey.z, ez.x, ez.y, ez.z, at.x, at.y, at.z);
    const Way ways[] = {
        {place, ""},
        {"ObjectBegin \"all\"\n", "ObjectEnd\n" + place + "ObjectInstance \"all\"\n"},
        {"ObjectBegin \"all\"\n",
         "ObjectEnd\n" + place +
             fmt::format("ActiveTransform EndTime\nTranslate {} {} {}\nActiveTransform All\nObjectInstance \"all\"\n", velocity.x,
                         velocity.y, velocity.z),
         true}};
    Random random;
    for (const Way& way : ways) {
        int compared = 0, hits = 0;
        for (int scene = 0; scene < 8; ++scene) {
            const Lattice lattice(random);
            const Built built = build(media + way.before + lattice.text() + way.after);
            for (int i = 0; i < 3000; ++i) {
                SCOPED_TRACE(fmt::format("ray {} of scene {}", i, scene));
                const Vec3f middle{1.5f, 1.5f, 1.5f};
                const Vec3d from(middle + random.direction() * 6.0f);
                Vec3d to(middle + random.vector(1.5f));  // or close to an edge or a corner
                const auto nearly_round = [&](double x) { return std::round(x) + static_cast<double>(random(-1e-3f, 1e-3f)); };
                if (i % 3 > 0) to.x = nearly_round(to.x), to.y = nearly_round(to.y);
                if (i % 3 > 1) to.z = nearly_round(to.z);
                const Vec3d d = normalize(to - from);
                const float time = way.moves ? random(0, 1) : 0;
                const Ray ray{Vec3f(at + in_world(from + velocity * static_cast<double>(time))), Vec3f(in_world(d)), kInfinity,
                              time};
                std::vector<Event> events;
                double sheet = 0;
                if (!lattice.meet(from, d, events, sheet)) continue;

                const Line line = built.geometry->trace(ray, Stop::kFirstSolid);
                ASSERT_EQ(line.hit.has_value(), sheet < kInfinity);
                const Ray shorter{ray.o, ray.d, static_cast<float>(std::min(sheet, 20.0) - kNear), time};
                const Line shadow = built.geometry->trace(shorter, Stop::kAnySolid);
                EXPECT_EQ(shadow.passed, 1);
                if (line.hit) {
                    ++hits;
                    EXPECT_NEAR(line.hit->t, sheet, 1e-4);
                    EXPECT_EQ(built.geometry->trace(ray, Stop::kAnySolid).passed, 0);
                }
                events.push_back({20, 0, 0});
                Count count;
                double before = 0;
                for (const Event& event : events) {
                    const std::optional<std::uint32_t> medium = count.medium();
                    const double begin = std::exchange(before, event.t);
                    count.cross(event);
                    if (!medium || event.t - begin < kNear) continue;
                    if (event.t <= sheet) {
                        ++compared;
                        EXPECT_EQ(medium_at(line, (begin + event.t) / 2), *medium);
                        EXPECT_EQ(medium_at(shadow, (begin + event.t) / 2), *medium);
                    }
                    if (!line.hit) continue;
                    const SurfaceHit& hit = *line.hit;
                    const auto at_sheet = [&](const Vec3f& w) {
                        if (hit.inside_medium == hit.outside_medium) return medium_at(line, sheet);
                        return leads_out(hit, w) ? hit.outside_medium : hit.inside_medium;
                    };
                    if (begin < sheet - kNear && event.t > sheet - 1e-6) {
                        EXPECT_EQ(at_sheet(-ray.d), *medium);
                    }
                    if (begin < sheet + 1e-6 && event.t > sheet + kNear) {
                        EXPECT_EQ(at_sheet(ray.d), *medium);
                    }
                }
            }
        }
        EXPECT_GT(compared, 30'000);
        EXPECT_GT(hits, 2'000);
    }
}

}  // namespace
}  // namespace latent::render
