#include <carom/collision/static_bvh.hpp>

#include <carom/collision/detail/wide_build.hpp>
#include <carom/collision/detail/wide_bvh.hpp>

#include <string>
#include <utility>

namespace carom {
namespace {

static_assert(StaticBvh::kMaxTriangles == WideBvh::kMaxTriangles);

Status check(std::span<const vec3> vertices, std::span<const StaticBvh::Triangle> triangles) {
    constexpr const char* kWhere = "StaticBvh::build";
    if (triangles.empty()) return Error{ErrorCode::Empty, "a hierarchy needs at least one triangle", kWhere};
    if (triangles.size() > StaticBvh::kMaxTriangles) {
        return Error{ErrorCode::InvalidArgument, "a hierarchy holds at most 2^28 triangles", kWhere};
    }
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (!is_finite(vertices[i])) {
            return Error{ErrorCode::NotFinite, "vertex " + std::to_string(i) + " is not finite", kWhere};
        }
    }
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        for (const std::uint32_t v : triangles[i]) {
            if (v >= vertices.size()) {
                return Error{ErrorCode::InvalidArgument,
                             "triangle " + std::to_string(i) + " names vertex " + std::to_string(v) + " of " +
                                 std::to_string(vertices.size()),
                             kWhere};
            }
        }
    }
    return {};
}

}  // namespace

StaticBvh::StaticBvh(WideBvh&& wide) : wide_(std::make_unique<const WideBvh>(std::move(wide))) {}
StaticBvh::StaticBvh(StaticBvh&&) noexcept = default;
StaticBvh& StaticBvh::operator=(StaticBvh&&) noexcept = default;
StaticBvh::~StaticBvh() = default;

Result<StaticBvh> StaticBvh::build(std::span<const vec3> vertices, std::span<const Triangle> triangles, Executor& executor) {
    if (Status status = check(vertices, triangles); !status) return status.error();
    return StaticBvh(build_wide_bvh(vertices, triangles, executor));
}

Result<StaticBvh> StaticBvh::build(std::span<const vec3> vertices, std::span<const Triangle> triangles) {
    SerialExecutor serial;
    return build(vertices, triangles, serial);
}

std::size_t StaticBvh::triangle_count() const noexcept { return wide_->triangle_count; }
std::size_t StaticBvh::bytes() const noexcept { return sizeof(WideBvh) + wide_->lines.capacity() * sizeof(WideBvh::Line); }
double StaticBvh::sah_cost() const noexcept { return wide_->sah_cost; }

Aabb StaticBvh::bounds() const noexcept {
    const double unit = 1.0 / static_cast<double>(wide_->scale);
    return {unit * dvec3(wide_->lower), unit * dvec3(wide_->upper)};
}

}  // namespace carom
