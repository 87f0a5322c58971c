#include <carom/narrowphase/detail/gjk_simplex.hpp>

namespace carom::detail {

Simplex nearest_on_segment(const Corner& a, const Corner& b) noexcept {
    Simplex s;
    s.add(a, 1.0);
    s.add(b, 1.0);
    s.keep(part_of_segment(s, 0, 1));
    return s;
}

SimplexPart nearest_part(const Simplex& s, bool curved) noexcept {
    switch (s.count) {
        case 2:
            return part_of_segment(s, 0, 1);
        case 3:
            return curved ? part_of_sliver(s, 0, 1, 2) : part_of_triangle(s, 0, 1, 2);
        case 4:
            return curved ? part_of_tetrahedron<true>(s) : part_of_tetrahedron<false>(s);
        default:
            break;
    }
    SimplexPart point;
    point.add(0, 1.0, 1.0);
    return point;
}

}  // namespace carom::detail
