#include <carom/dynamics/detail/path_touch.hpp>

#include <algorithm>

namespace carom::dynamics {
namespace {

constexpr double kCoarse = 0.25;   // of the reach: pieces that bend more are split without a look
constexpr int kMostResumed = 16;   // looks of a search: many turns of a rod beside a wall may take more than one

// Each look but the last ends a search that may have one look less; a closed form has one.
void note_looks(const PathSearch& search, const MovingShape& a, const MovingShape& b, TimeOfImpactSettings settings, double begin,
                double end, Cores& cores) {
    const int most = settings.most_checks;
    for (settings.most_checks = 1; settings.most_checks < most; ++settings.most_checks) {
        const Impact impact = first_touch(a, search.level, b, settings, cores);
        if (impact.status != ImpactStatus::Clamped) return;
        search.looks->push_back(begin + impact.t * (end - begin));
    }
}

bool touch_pieces(PathSearch& search, double begin, double end, std::uint32_t number_a, std::uint32_t number_b, Cores& cores) {
    BodyPath &path_a = *search.a.path, &path_b = *search.b.path;
    const PathPiece a = cut(path_a.piece(number_a), begin, end), b = cut(path_b.piece(number_b), begin, end);
    const Aabb box_b = search.still ? *search.still : box_of(b, search.b.reach);
    if (!overlaps(box_of(a, search.a.reach + search.separation), box_b)) return false;
    const double bend = a.bend + b.bend;
    ++search.pieces;
    const bool split_a = path_a.can_split(number_a) && (a.bend >= b.bend || !path_b.can_split(number_b)),
               split_b = !split_a && path_b.can_split(number_b);
    if (!(split_a || split_b) || bend < kCoarse * search.a.reach) {
        const MovingShape shape_a{search.a.shape, shape_motion(a, *search.a.local)},
            shape_b{search.b.shape, shape_motion(b, *search.b.local)};
        const TimeOfImpactSettings settings{.separation = bend + search.separation, .tolerance = search.tolerance};
        const Impact impact = first_touch(shape_a, search.level, shape_b, settings, cores);
        if (search.looks != nullptr) note_looks(search, shape_a, shape_b, settings, begin, end, cores);
        if (!may_touch(impact.status) || impact.status == ImpactStatus::Invalid) return false;
        if (!(split_a || split_b)) {
            if (impact.status == ImpactStatus::Clamped && impact.t > 0.0 && ++search.resumed <= kMostResumed) {
                return touch_pieces(search, begin + impact.t * (end - begin), end, number_a, number_b, cores);
            }
            search.t = begin + impact.t * (end - begin);
            search.impact = impact;
            search.bend = bend;
            if (impact.status == ImpactStatus::Overlapping &&
                begin > search.from) {  // within the bend: which way is told by where they are going
                const Impact closer = first_touch(shape_a, search.level, shape_b, {.tolerance = search.tolerance}, cores);
                search.impact.point = closer.point, search.impact.normal = closer.normal;
            }
            return true;
        }
        begin += impact.t * (end - begin);  // nothing before that
    }
    const auto [earlier, later] = split_a ? path_a.split(number_a) : path_b.split(number_b);
    const double middle = (split_a ? path_a : path_b).piece(earlier).end;
    const auto half = [&](double from, double to, std::uint32_t piece) {
        return from < to && touch_pieces(search, from, to, split_a ? piece : number_a, split_a ? number_b : piece, cores);
    };
    return half(begin, std::min(middle, end), earlier) || half(std::max(begin, middle), end, later);
}

}  // namespace

bool touch(PathSearch& search, double begin, double end, Cores& cores) {
    return touch_pieces(search, begin, end, BodyPath::kWhole, BodyPath::kWhole, cores);
}

}  // namespace carom::dynamics
