// The simplex of the GJK algorithm: up to four points of the difference of two sets, and the part of it nearest to the origin.
//
//   simplex.add(support, 1.0);
//   simplex.keep(nearest_part(simplex, false));  // only the corners that hold the nearest point, with their weights
//   dvec3 v = simplex.point();
#pragma once

#include <carom/narrowphase/detail/simplex_parts.hpp>

#include <bit>
#include <cstddef>

namespace carom::detail {

/// A point of the difference.
struct Corner {
    dvec3 w{0.0};  // on_a - on_b
    dvec3 on_a{0.0};
    dvec3 on_b{0.0};
    std::size_t index_a = 0, index_b = 0;
    double weight = 1.0;
};

/// Corners whose weights give its point. They stay where they were put, whichever of them are kept: copying them would cost a search more than its
/// arithmetic.
class Simplex {
public:
    int count = 0;

    Simplex() noexcept {}
    Simplex(const Simplex& other) noexcept { *this = other; }
    Simplex& operator=(const Simplex& other) noexcept {
        for (int i = 0; i < other.count; ++i) {
            place_[i] = other.place_[i];
            corners_[place_[i]].corner = other[i];
        }
        count = other.count;
        return *this;
    }

    [[nodiscard]] const Corner& operator[](int i) const noexcept { return corners_[place_[i]].corner; }
    /// A corner after the last: there is room for four.
    Corner& add() noexcept {
        unsigned taken = 0;
        for (int i = 0; i < count; ++i) taken |= 1u << place_[i];
        place_[count] = std::countr_one(taken);
        return corners_[place_[count++]].corner;
    }
    void add(const Corner& c, double weight) noexcept {
        Corner& to = add();
        to = c;
        to.weight = weight;
    }
    void drop_last() noexcept { --count; }
    /// Keeps the corners of the part, in its order.
    void keep(const SimplexPart& part) noexcept {
        int places[4];
        for (int i = 0; i < part.count; ++i) {
            places[i] = place_[part.corner[i]];
            corners_[places[i]].corner.weight = part.weight[i];
        }
        for (int i = 0; i < part.count; ++i) place_[i] = places[i];
        count = part.count;
    }
    /// Moves the points of the difference.
    void shift(const dvec3& by) noexcept {
        for (int i = 0; i < count; ++i) corners_[place_[i]].corner.w += by;
    }
    [[nodiscard]] dvec3 point() const noexcept {
        dvec3 sum{0.0};
        for (int i = 0; i < count; ++i) sum += (*this)[i].weight * (*this)[i].w;
        return sum;
    }

private:
    union Place {
        Corner corner;
        Place() noexcept {}
    };
    Place corners_[4];
    int place_[4];
};

[[nodiscard]] inline bool same(const Corner& a, const Corner& b) noexcept {
    return a.index_a == b.index_a && a.index_b == b.index_b && a.w == b.w;
}

[[nodiscard]] Simplex nearest_on_segment(const Corner& a, const Corner& b) noexcept;

/// The part of the simplex that is nearest to the origin; all four corners of a tetrahedron that holds it.
/// @param curved  for support points of curved surfaces, which make triangles and tetrahedra so thin that rounding decides on which side
///                of them the origin lies: tries all parts and measures.
[[nodiscard]] SimplexPart nearest_part(const Simplex& simplex, bool curved) noexcept;

}  // namespace carom::detail
