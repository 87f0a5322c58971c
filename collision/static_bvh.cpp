#include <carom/collision/static_bvh.hpp>

#include <carom/collision/detail/check_mesh.hpp>
#include <carom/collision/detail/wide_build.hpp>
#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/collision/detail/wide_refit.hpp>

#include <atomic>
#include <cstdint>
#include <string>
#include <utility>

namespace carom {
namespace {

static_assert(StaticBvh::kMaxTriangles == WideBvh::kMaxTriangles);

std::uint64_t next_id() noexcept {
    static std::atomic<std::uint64_t> last{0};
    return last.fetch_add(1, std::memory_order_relaxed) + 1;
}

}  // namespace

StaticBvh::StaticBvh(WideBvh&& wide) : wide_(std::make_unique<WideBvh>(std::move(wide))) { wide_->id = next_id(); }
StaticBvh::StaticBvh(StaticBvh&&) noexcept = default;
StaticBvh& StaticBvh::operator=(StaticBvh&&) noexcept = default;
StaticBvh::~StaticBvh() = default;

Result<StaticBvh> StaticBvh::build(std::span<const vec3> vertices, std::span<const Triangle> triangles, Executor& executor) {
    if (Status status = check_mesh(vertices, triangles, "StaticBvh::build"); !status) return status.error();
    return StaticBvh(build_wide_bvh(vertices, triangles, executor));
}

Result<StaticBvh> StaticBvh::build(std::span<const vec3> vertices, std::span<const Triangle> triangles) {
    SerialExecutor serial;
    return build(vertices, triangles, serial);
}

Status StaticBvh::refit(std::span<const vec3> vertices, std::span<const Triangle> triangles) {
    constexpr const char* kWhere = "StaticBvh::refit";
    if (Status status = check_mesh(vertices, triangles, kWhere); !status) return status.error();
    if (triangles.size() != wide_->triangle_count) {
        return Error{ErrorCode::InvalidArgument,
                     std::to_string(triangles.size()) + " triangles for a hierarchy of " + std::to_string(wide_->triangle_count), kWhere};
    }
    return refit_wide_bvh(*wide_, vertices, triangles);
}

std::size_t StaticBvh::triangle_count() const noexcept { return wide_->triangle_count; }
std::size_t StaticBvh::bytes() const noexcept { return sizeof(WideBvh) + wide_->lines.capacity() * sizeof(WideBvh::Line); }
double StaticBvh::sah_cost() const noexcept { return wide_->sah_cost; }
double StaticBvh::degradation() const noexcept { return wide_->crowding / wide_->built_crowding; }

Aabb StaticBvh::bounds() const noexcept {
    const double unit = 1.0 / static_cast<double>(wide_->scale);
    return {unit * dvec3(wide_->lower), unit * dvec3(wide_->upper)};
}

}  // namespace carom
