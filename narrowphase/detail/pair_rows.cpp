#include <carom/narrowphase/detail/pair_rows.hpp>

namespace carom::detail {
namespace {

void put_pose(const Pose& pose, DoubleBundle (&rows)[7], std::size_t lane) noexcept {
    const dquat& q = pose.orientation;
    const double numbers[7] = {pose.position.x, pose.position.y, pose.position.z, q.x, q.y, q.z, q.w};
    for (std::size_t k = 0; k < 7; ++k) rows[k].lane[lane] = numbers[k];
}

void put_size(const Shape& shape, DoubleBundle* rows, std::size_t lane) noexcept {
    const auto put = [&](std::size_t row, float number) { rows[row].lane[lane] = static_cast<double>(number); };
    if (const Sphere* sphere = std::get_if<Sphere>(&shape)) put(0, sphere->radius);
    if (const Capsule* capsule = std::get_if<Capsule>(&shape)) put(0, capsule->radius), put(1, capsule->half_segment);
    if (const Box* box = std::get_if<Box>(&shape)) put(0, box->half_extents.x), put(1, box->half_extents.y), put(2, box->half_extents.z);
    if (const Plane* plane = std::get_if<Plane>(&shape)) {
        put(0, plane->normal.x), put(1, plane->normal.y), put(2, plane->normal.z), put(3, plane->offset);
    }
}

}  // namespace

void PairRows::fill(const BatchInput& input, std::span<const std::uint32_t> chosen, bool swapped) noexcept {
    for (std::size_t lane = 0; lane < kDoubleBundleWidth; ++lane) {
        const std::uint32_t index = chosen[lane < chosen.size() ? lane : 0];
        const NumberedPair& pair = input.pairs[index];
        const std::uint32_t a = swapped ? pair.b : pair.a, b = swapped ? pair.a : pair.b;
        put_pose(input.placed.poses[a], first, lane);
        put_pose(input.placed.poses[b], second, lane);
        put_size(*input.placed.shapes[a], size_first, lane);
        put_size(*input.placed.shapes[b], size_second, lane);
        margin.lane[lane] = static_cast<double>(input.margin(index));
    }
}

template <std::size_t Points>
void ContactRows<Points>::write(std::span<const std::uint32_t> chosen, ManifoldList& out) const {
    const auto read = [](const HalfBundle(&rows)[3], std::size_t lane) {
        return vec3(rows[0].lane[lane], rows[1].lane[lane], rows[2].lane[lane]);
    };
    unsigned any = 0;
    for (const Point& point : points) any |= point.valid;
    for (std::size_t lane = 0; lane < chosen.size(); ++lane) {
        if ((any >> lane & 1u) == 0) continue;
        Manifold& manifold = out.add();
        manifold.pair = chosen[lane];
        manifold.normal = read(normal, lane);
        for (const Point& point : points) {
            if ((point.valid >> lane & 1u) == 0) continue;
            manifold.points[manifold.count++] = {read(point.position, lane), point.separation.lane[lane],
                                                 static_cast<std::uint64_t>(static_cast<std::int64_t>(point.feature.lane[lane]))};
        }
    }
}

template struct ContactRows<1>;
template struct ContactRows<2>;
template struct ContactRows<4>;

}  // namespace carom::detail
