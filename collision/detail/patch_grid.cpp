#include <carom/collision/detail/patch_grid.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace carom::detail {
namespace {

using Curve = std::array<dvec3, 4>;

dvec3 between(const dvec3& a, const dvec3& b, double t) { return a + t * (b - a); }

dvec3 point_on(const Curve& c, double t) {
    const dvec3 a = between(c[0], c[1], t), b = between(c[1], c[2], t), d = between(c[2], c[3], t);
    return between(between(a, b, t), between(b, d, t), t);
}

dvec3 point_on(const BezierPatch& patch, double u, double v) {
    Curve column{};
    for (std::size_t i = 0; i < 4; ++i) {
        column[i] = point_on(Curve{patch.points[4 * i], patch.points[4 * i + 1], patch.points[4 * i + 2],
                                   patch.points[4 * i + 3]}, u);
    }
    return point_on(column, v);
}

// The bound on the second derivative of a cubic, which is a blend of 6 times the two second differences. Summed so that the
// curve walked backwards gives the same bits.
double second_derivative(const Curve& c) {
    return 6.0 * std::max(glm::length((c[0] + c[2]) - 2.0 * c[1]), glm::length((c[1] + c[3]) - 2.0 * c[2]));
}

// The four curves of a patch along u (rows) or along v (columns).
std::array<Curve, 4> curves(const BezierPatch& patch, bool rows) {
    std::array<Curve, 4> out{};
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            out[rows ? i : j][rows ? j : i] = patch.points[4 * i + j];
        }
    }
    return out;
}

double mixed_derivative(const BezierPatch& patch) {
    double most = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            const std::size_t k = 4 * i + j;
            const dvec3 twist = (patch.points[k + 5] - patch.points[k + 4]) - (patch.points[k + 1] - patch.points[k]);
            most = std::max(most, glm::length(twist));
        }
    }
    return 9.0 * most;
}

bool is_point(const Curve& c) { return c[0] == c[1] && c[1] == c[2] && c[2] == c[3]; }

// An edge of the patch in the order of PatchGrid's walk.
Curve edge_of(const BezierPatch& patch, std::size_t side) {
    const auto& p = patch.points;
    switch (side) {
        case 0: return {p[0], p[1], p[2], p[3]};
        case 1: return {p[3], p[7], p[11], p[15]};
        case 2: return {p[15], p[14], p[13], p[12]};
        default: return {p[12], p[8], p[4], p[0]};
    }
}

// What the strip along one edge has to bridge.
struct Strip {
    double along_edge = 0.0;   // the bound on the second derivative along the edge, at the edge
    double along_inside = 0.0; // the same over the whole patch
    double mixed = 0.0;
    double across = 0.0;       // the second derivative across the strip, over the whole patch
    double step = 0.0;         // the widest triangle along the edge
};

// How deep the strip may be so that its triangles keep the bound. Over a strip of depth y the second derivative along the edge
// is at most a + 3 y (b - a): at the edge a, by the weights of the other rows, which sum to 1 - (1 - y)^3 <= 3 y. The first
// part takes half of chord_error by the rule of the edge; the depth solves for the rest,
// across y^2 + (3 (b - a) step^2 + 2 mixed step) y = 4 chord_error.
double depth(const Strip& s, double chord_error) {
    const double linear =
        3.0 * std::max(0.0, s.along_inside - s.along_edge) * s.step * s.step + 2.0 * s.mixed * s.step;
    return 8.0 * chord_error / (linear + std::sqrt(linear * linear + 16.0 * chord_error * s.across));
}

// Grid lines from `first` to 1 - `last`, at most 1 / n apart.
std::vector<double> lines(double first, double last, int n) {
    const double regular = 1.0 / n;
    const double length = 1.0 - first - last;
    const int parts = first == regular && last == regular ? n - 2 : static_cast<int>(std::ceil(std::max(0.0, length) * n));
    std::vector<double> out;
    for (int i = 0; i <= parts; ++i) {
        out.push_back(parts == 0 ? first : first + length * i / parts);
    }
    return out;
}

std::vector<double> all_lines(int n) {
    std::vector<double> out;
    for (int i = 0; i <= n; ++i) {
        out.push_back(static_cast<double>(i) / n);
    }
    return out;
}

int parts_for(double derivative, double chord_error) {
    return static_cast<int>(std::clamp(std::ceil(std::sqrt(derivative / (4.0 * chord_error))), 1.0, kMaxDivisions + 1.0));
}

// The points of an edge, in the order of the walk. Evaluated from the end with the smaller points, so that the neighbour, who
// walks the other way, gets the same bits.
std::vector<dvec3> edge_points(const Curve& edge, int parts) {
    const auto key = [](const dvec3& p) { return std::tuple(p.x, p.y, p.z); };
    const Curve back{edge[3], edge[2], edge[1], edge[0]};
    const bool forward = std::tuple(key(edge[0]), key(edge[1])) <= std::tuple(key(back[0]), key(back[1]));
    const Curve& from = forward ? edge : back;
    std::vector<dvec3> out;
    for (int k = 0; k <= parts; ++k) {
        out.push_back(k == parts ? from[3] : point_on(from, static_cast<double>(k) / parts));
    }
    if (!forward) {
        std::reverse(out.begin(), out.end());
    }
    return out;
}

// A row of vertices along an edge, with their places in [0, 1] along the walk.
struct Row {
    std::vector<double> place;
    std::vector<std::uint32_t> vertex;
};

std::uint32_t add_vertex(MeshData& mesh, const dvec3& p) {
    mesh.vertices.push_back(vec3(p));
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

// Triangles between an edge and the first inner row, which lies to the left of the walk. Always the row whose next vertex
// comes first goes on, so that no triangle is wider than the wider step of the two.
void sew(MeshData& mesh, const Row& edge, const Row& inner) {
    std::size_t k = 0, i = 0;
    while (k + 1 < edge.vertex.size() || i + 1 < inner.vertex.size()) {
        const bool edge_next = i + 1 == inner.vertex.size() ||
                               (k + 1 < edge.vertex.size() && edge.place[k + 1] <= inner.place[i + 1]);
        if (edge_next) {
            mesh.triangles.push_back({edge.vertex[k], edge.vertex[k + 1], inner.vertex[i]});
            ++k;
        } else {
            mesh.triangles.push_back({edge.vertex[k], inner.vertex[i + 1], inner.vertex[i]});
            ++i;
        }
    }
}

// The row of the inner grid along a side, in the order of the walk; `base` is the grid's first vertex.
Row inner_row(const PatchGrid& grid, std::uint32_t base, std::size_t side) {
    const bool along_u = side % 2 == 0;
    const bool backward = side >= 2;
    const std::size_t columns = grid.u.size(), rows = grid.v.size();
    const std::vector<double>& line = along_u ? grid.u : grid.v;
    Row row;
    for (std::size_t n = 0; n < line.size(); ++n) {
        const std::size_t k = backward ? line.size() - 1 - n : n;
        const std::size_t i = along_u ? k : (side == 1 ? columns - 1 : 0);
        const std::size_t j = along_u ? (side == 0 ? 0 : rows - 1) : k;
        row.place.push_back(backward ? 1.0 - line[k] : line[k]);
        row.vertex.push_back(base + static_cast<std::uint32_t>(j * columns + i));
    }
    return row;
}

// The quads between grid lines, each as two triangles.
void add_quads(MeshData& mesh, std::uint32_t base, std::size_t columns, std::size_t rows) {
    for (std::size_t j = 0; j + 1 < rows; ++j) {
        for (std::size_t i = 0; i + 1 < columns; ++i) {
            const std::uint32_t a = base + static_cast<std::uint32_t>(j * columns + i);
            const std::uint32_t b = a + static_cast<std::uint32_t>(columns);
            mesh.triangles.push_back({a, a + 1, b + 1});
            mesh.triangles.push_back({a, b + 1, b});
        }
    }
}

}  // namespace

int edge_divisions(const std::array<dvec3, 4>& edge, double chord_error) {
    return parts_for(second_derivative(edge), chord_error);
}

std::optional<PatchGrid> plan_grid(const BezierPatch& patch, double chord_error) {
    const std::array<Curve, 4> rows = curves(patch, true), columns = curves(patch, false);
    double along_u = 0.0, along_v = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
        along_u = std::max(along_u, second_derivative(rows[i]));
        along_v = std::max(along_v, second_derivative(columns[i]));
    }
    const double mixed = mixed_derivative(patch);

    PatchGrid grid;
    std::array<bool, 4> point{};
    // 2 w h <= w^2 + h^2 gives each direction half of chord_error.
    int nu = parts_for(along_u + mixed, chord_error), nv = parts_for(along_v + mixed, chord_error);
    for (std::size_t side = 0; side < 4; ++side) {
        const Curve edge = edge_of(patch, side);
        point[side] = is_point(edge);
        grid.edge[side] = edge_divisions(edge, chord_error);
        int& n = side % 2 == 0 ? nu : nv;
        n = std::max(n, grid.edge[side]);
    }
    if (nu > kMaxDivisions || nv > kMaxDivisions) {
        return std::nullopt;
    }
    // A pole has no length to divide: it takes the division of the inside.
    const auto matches = [&](std::size_t side) { return point[side] || grid.edge[side] == (side % 2 == 0 ? nu : nv); };
    grid.whole = matches(0) && matches(1) && matches(2) && matches(3);
    if (!grid.whole) {
        nu = std::max(nu, 2);
        nv = std::max(nv, 2);
    }
    std::array<double, 4> inset{};
    for (std::size_t side = 0; side < 4; ++side) {
        const bool u_edge = side % 2 == 0;
        const int along = u_edge ? nu : nv, across = u_edge ? nv : nu;
        inset[side] = 1.0 / across;
        if (point[side]) {
            grid.edge[side] = along;
        } else if (grid.edge[side] != along) {
            const Strip strip{second_derivative(edge_of(patch, side)), u_edge ? along_u : along_v, mixed,
                              u_edge ? along_v : along_u, 1.0 / grid.edge[side]};
            inset[side] = std::min(inset[side], depth(strip, chord_error));
        }
    }
    grid.u = grid.whole ? all_lines(nu) : lines(inset[3], inset[1], nu);
    grid.v = grid.whole ? all_lines(nv) : lines(inset[0], inset[2], nv);
    return grid;
}

void append(MeshData& mesh, const BezierPatch& patch, const PatchGrid& grid) {
    const std::size_t columns = grid.u.size(), rows = grid.v.size();
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (double v : grid.v) {
        for (double u : grid.u) {
            add_vertex(mesh, point_on(patch, u, v));
        }
    }
    add_quads(mesh, base, columns, rows);
    for (std::size_t side = 0; side < 4; ++side) {
        const std::vector<dvec3> points = edge_points(edge_of(patch, side), grid.edge[side]);
        const Row inner = inner_row(grid, base, side);
        Row edge;
        for (std::size_t k = 0; k < points.size(); ++k) {
            if (grid.whole) {
                // The same places in (u, v), but with the bits that the neighbour has too.
                mesh.vertices[inner.vertex[k]] = vec3(points[k]);
            } else {
                edge.place.push_back(static_cast<double>(k) / grid.edge[side]);
                edge.vertex.push_back(add_vertex(mesh, points[k]));
            }
        }
        if (!grid.whole) {
            sew(mesh, edge, inner);
        }
    }
}

}  // namespace carom::detail
