#include "render/load/mesh/loop_subdivision.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <unordered_map>

namespace latent::render {
namespace {

constexpr std::uint32_t kNobody = 0xFFFFFFFF;
constexpr double kMaxTriangles = 1 << 24;  // each takes some 400 bytes while they are made

using Triangles = std::vector<std::uint32_t>;  // 3 indices each

// The vertices opposite to an edge, from a < b.
struct Edge {
    std::uint32_t a, b;
    std::uint32_t opposite[2] = {kNobody, kNobody};  // in the triangle that goes from a to b, and in the one from b to a

    bool is_boundary() const { return opposite[0] == kNobody || opposite[1] == kNobody; }
};

class Edges {
 public:
    static Result<Edges> of(const Triangles& triangles) {
        Edges edges;
        edges.index_.reserve(triangles.size() / 2);
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            const std::size_t first = i - i % 3;
            const std::uint32_t from = triangles[i], to = triangles[first + (i + 1) % 3];
            const auto [at, is_new] = edges.index_.try_emplace(key(from, to), static_cast<std::uint32_t>(edges.all_.size()));
            if (is_new) edges.all_.push_back({std::min(from, to), std::max(from, to)});
            std::uint32_t& opposite = edges.all_[at->second].opposite[from < to ? 0 : 1];
            if (from == to || opposite != kNobody) {
                return Error{
                    ErrorCode::kUnsupported,
                    fmt::format("the triangles at the edge from vertex {} to {} do not make a surface with two sides", from, to)};
            }
            opposite = triangles[first + (i + 2) % 3];
        }
        return edges;
    }
    const std::vector<Edge>& all() const { return all_; }
    std::uint32_t index(std::uint32_t a, std::uint32_t b) const { return index_.at(key(a, b)); }

 private:
    static std::uint64_t key(std::uint32_t a, std::uint32_t b) { return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b); }

    std::vector<Edge> all_;
    std::unordered_map<std::uint64_t, std::uint32_t> index_;
};

// What the rules need to know of the neighbours of each vertex: all of them, or, at a boundary, the two along it.
struct Neighbours {
    Vec3d sum{};
    std::uint32_t count = 0;
    bool at_boundary = false;
};

std::vector<Neighbours> neighbours_of(const std::vector<Vec3d>& p, const Edges& edges) {
    std::vector<Neighbours> neighbours(p.size());
    for (const Edge& e : edges.all()) {
        if (e.is_boundary()) neighbours[e.a].at_boundary = neighbours[e.b].at_boundary = true;
    }
    const auto add = [&](std::uint32_t to, std::uint32_t from, bool along_boundary) {
        if (neighbours[to].at_boundary && !along_boundary) return;
        neighbours[to].sum = neighbours[to].sum + p[from];
        ++neighbours[to].count;
    };
    for (const Edge& e : edges.all()) {
        add(e.a, e.b, e.is_boundary());
        add(e.b, e.a, e.is_boundary());
    }
    return neighbours;
}

Vec3d weighted(const Vec3d& p, const Neighbours& n, double of_each) { return p * (1 - of_each * n.count) + n.sum * of_each; }

// Warren's weight of each neighbour in a division.
double division_weight(const Neighbours& n) {
    if (n.at_boundary) return 1.0 / 8;
    return n.count == 3 ? 3.0 / 16 : 3.0 / (8.0 * n.count);
}
// In the limit.
double limit_weight(const Neighbours& n) { return n.at_boundary ? 1.0 / 6 : 1 / (n.count + 3 / (8 * division_weight(n))); }

void divide(std::vector<Vec3d>& p, Triangles& triangles, const Edges& edges) {
    const std::vector<Neighbours> neighbours = neighbours_of(p, edges);
    std::vector<Vec3d> next;
    next.reserve(p.size() + edges.all().size());
    for (std::size_t i = 0; i < p.size(); ++i)
        next.push_back(neighbours[i].count ? weighted(p[i], neighbours[i], division_weight(neighbours[i])) : p[i]);
    for (const Edge& e : edges.all()) {
        const Vec3d ends = p[e.a] + p[e.b];
        next.push_back(e.is_boundary() ? ends * 0.5 : ends * (3.0 / 8) + (p[e.opposite[0]] + p[e.opposite[1]]) * (1.0 / 8));
    }
    Triangles quarters;
    quarters.reserve(4 * triangles.size());
    for (std::size_t i = 0; i < triangles.size(); i += 3) {
        const std::uint32_t a = triangles[i], b = triangles[i + 1], c = triangles[i + 2];
        const auto middle = [&](std::uint32_t from, std::uint32_t to) {
            return static_cast<std::uint32_t>(p.size()) + edges.index(from, to);
        };
        const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        quarters.insert(quarters.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
    }
    p = std::move(next);
    triangles = std::move(quarters);
}

// The neighbours around each vertex, in the order of the triangles; at a boundary from its one edge to the other. Of all vertices
// in one array, `begin` where each one's start.
struct Rings {
    std::vector<std::uint32_t> begin, vertex;
};

Result<Rings> rings_of(std::size_t vertices, const Triangles& triangles, const std::vector<Neighbours>& neighbours) {
    struct Corner {
        std::uint32_t next, after;  // the other two vertices of a triangle
    };
    std::vector<std::uint32_t> first(vertices + 1);
    for (const std::uint32_t v : triangles) ++first[v + 1];
    for (std::size_t v = 0; v < vertices; ++v) first[v + 1] += first[v];
    std::vector<Corner> corners(triangles.size());
    std::vector<std::uint32_t> filled(first.begin(), first.end() - 1);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const std::size_t t = i - i % 3;
        corners[filled[triangles[i]]++] = {triangles[t + (i + 1) % 3], triangles[t + (i + 2) % 3]};
    }
    Rings rings;
    rings.begin.push_back(0);
    for (std::size_t v = 0; v < vertices; ++v) {
        const std::span<Corner> around(corners.data() + first[v], first[v + 1] - first[v]);
        const auto starting_at = [&](std::uint32_t w) { return std::ranges::find(around, w, &Corner::next); };
        if (!around.empty()) {
            std::uint32_t at = around[0].next;
            for (const Corner& c : around) {
                if (neighbours[v].at_boundary && std::ranges::find(around, c.next, &Corner::after) == around.end()) at = c.next;
            }
            std::size_t met = 0;
            auto corner = starting_at(at);
            for (; corner != around.end() && met < around.size(); corner = starting_at(corner->after), ++met) {
                rings.vertex.push_back(corner->next);
                if (neighbours[v].at_boundary && met + 1 == around.size()) rings.vertex.push_back(corner->after);
            }
            if (met < around.size()) {
                return Error{ErrorCode::kUnsupported, fmt::format("the triangles at vertex {} do not make one surface", v)};
            }
        }
        rings.begin.push_back(static_cast<std::uint32_t>(rings.vertex.size()));
    }
    return rings;
}

// Two tangents of the limit surface, from its ring of n neighbours [Hoppe94].
Vec3f limit_normal(const std::vector<Vec3d>& p, std::size_t v, std::span<const std::uint32_t> ring, bool at_boundary) {
    const std::size_t n = ring.size();
    const auto at = [&](std::size_t j) { return p[ring[j]]; };
    Vec3d s{}, t{};
    if (!at_boundary) {
        for (std::size_t j = 0; j < n; ++j) {
            const double angle = 2 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(n);
            s = s + at(j) * std::cos(angle);
            t = t + at(j) * std::sin(angle);
        }
    } else if (n >= 2) {
        s = at(0) - at(n - 1);
        if (n == 2) {
            t = at(0) + at(1) - p[v] * 2;
        } else if (n == 3) {
            t = at(1) - p[v];
        } else if (n == 4) {
            t = (at(1) + at(2)) * 2 - at(0) - at(3) - p[v] * 2;
        } else {
            const double angle = std::numbers::pi / static_cast<double>(n - 1);
            t = (at(0) + at(n - 1)) * -std::sin(angle);
            for (std::size_t j = 1; j + 1 < n; ++j)
                t = t + at(j) * ((2 - 2 * std::cos(angle)) * std::sin(static_cast<double>(j) * angle));
        }
    }
    const Vec3d normal = cross(t, s);
    const double size = length(normal);
    return size > 0 ? Vec3f(normal / size) : Vec3f{};
}

}  // namespace

Result<LoadedMesh> subdivide(const LoadedMesh& mesh, std::uint32_t levels) {
    const double triangles = std::ldexp(static_cast<double>(mesh.indices.size() / 3), static_cast<int>(2 * levels));
    if (triangles > kMaxTriangles) {
        return Error{ErrorCode::kUnsupported, fmt::format("levels: {} make {:.0f} triangles; at most {:.0f} are supported", levels,
                                                          triangles, kMaxTriangles)};
    }
    LoadedMesh out{.positions = mesh.positions, .indices = mesh.indices};
    for (std::uint32_t level = 0; level < levels; ++level) {
        const Result<Edges> edges = Edges::of(out.indices);
        if (!edges) return edges.error();
        divide(out.positions, out.indices, *edges);
    }
    const Result<Edges> edges = Edges::of(out.indices);
    if (!edges) return edges.error();
    const std::vector<Neighbours> neighbours = neighbours_of(out.positions, *edges);
    const Result<Rings> rings = rings_of(out.positions.size(), out.indices, neighbours);
    if (!rings) return rings.error();
    for (std::size_t v = 0; v < out.positions.size(); ++v) {
        const std::span<const std::uint32_t> ring(rings->vertex.data() + rings->begin[v], rings->begin[v + 1] - rings->begin[v]);
        out.normals.push_back(limit_normal(out.positions, v, ring, neighbours[v].at_boundary));
    }
    for (std::size_t v = 0; v < out.positions.size(); ++v) {
        if (neighbours[v].count) out.positions[v] = weighted(out.positions[v], neighbours[v], limit_weight(neighbours[v]));
    }
    return out;
}

}  // namespace latent::render
