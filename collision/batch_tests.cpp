#include <carom/collision/batch_tests.hpp>

#include <carom/collision/detail/batch_kernels.hpp>
#include <carom/core/check.hpp>

#include <algorithm>
#include <limits>
#include <source_location>

namespace carom::geo {
namespace {

/// Reports a wrong length as the caller's, not as that of a template in here.
bool have_room(std::size_t items, std::size_t out, std::source_location where = std::source_location::current()) {
    if (items != out) report_error(ErrorCode::InvalidArgument, "the output must be as long as the input", where);
    return items == out;
}

// Runs `kernel` on a block of items at a time, then `one` for each that it leaves open.
template <class Item, class Out, class Kernel, class One>
void run(std::span<const Item> items, std::span<Out> out, Kernel&& kernel, One&& one) {
    for (std::size_t first = 0; first < items.size(); first += detail::kBlock) {
        const std::size_t count = std::min(detail::kBlock, items.size() - first);
        std::int32_t unclear[detail::kBlock + 16];
        const std::size_t unsure = kernel(items.subspan(first, count), out.data() + first, unclear);
        for (std::size_t k = 0; k < unsure; ++k) {
            const std::size_t i = first + static_cast<std::size_t>(unclear[k]);
            out[i] = one(items[i]);
        }
    }
}

template <class Item>
float first_hit(const Item& item, const Ray<float>& ray) {
    const auto hit = cast_ray(item, ray);
    return hit ? hit->t : std::numeric_limits<float>::infinity();
}

}  // namespace

void cast_ray_batch(std::span<const Aabb<float>> boxes, const Ray<float>& ray, std::span<float> t) {
    if (!have_room(boxes.size(), t.size())) return;
    run(
        boxes, t, [&](auto items, float* out, std::int32_t* unclear) { return detail::ray_boxes(ray, items, out, unclear); },
        [&](const Aabb<float>& box) { return first_hit(box, ray); });
}

void cast_ray_batch(std::span<const Triangle<float>> triangles, const Ray<float>& ray, std::span<float> t) {
    if (!have_room(triangles.size(), t.size())) return;
    run(
        triangles, t, [&](auto items, float* out, std::int32_t* unclear) { return detail::ray_triangles(ray, items, out, unclear); },
        [&](const Triangle<float>& triangle) { return first_hit(triangle, ray); });
}

void overlaps_batch(std::span<const Aabb<float>> boxes, const Sphere<float>& sphere, std::span<std::uint8_t> hit) {
    if (!have_room(boxes.size(), hit.size())) return;
    run(
        boxes, hit, [&](auto items, std::uint8_t* out, std::int32_t* unclear) { return detail::sphere_boxes(sphere, items, out, unclear); },
        [&](const Aabb<float>& box) -> std::uint8_t { return overlaps(sphere, box) ? 1 : 0; });
}

void overlaps_batch(std::span<const Obb<float>> boxes, const Obb<float>& box, std::span<std::uint8_t> hit) {
    if (!have_room(boxes.size(), hit.size())) return;
    run(
        boxes, hit, [&](auto items, std::uint8_t* out, std::int32_t* unclear) { return detail::box_boxes(box, items, out, unclear); },
        [&](const Obb<float>& other) -> std::uint8_t { return overlaps(box, other) ? 1 : 0; });
}

void closest_points_batch(std::span<const Triangle<float>> triangles, const Vec3<float>& point, std::span<ClosestPoints<float>> closest) {
    if (!have_room(triangles.size(), closest.size())) return;
    run(
        triangles, closest,
        [&](auto items, ClosestPoints<float>* out, std::int32_t* unclear) { return detail::point_triangles(point, items, out, unclear); },
        [&](const Triangle<float>& triangle) { return closest_points(point, triangle); });
}

}  // namespace carom::geo
