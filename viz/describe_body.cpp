#include <carom/viz/make_debug_frame.hpp>

#include <cmath>
#include <sstream>

namespace carom {
namespace {

std::ostream& operator<<(std::ostream& out, const dvec3& v) {
    return out << '(' << v.x << ", " << v.y << ", " << v.z << ')';
}

}  // namespace

std::string describe_body(const World& world, BodyId body) {
    std::ostringstream out;
    out.precision(6);
    out << "body " << body.slot << ':' << body.generation;
    if (!world.is_alive(body)) {
        out << " is no longer there\n";
        return out.str();
    }
    if (!world.name(body).empty()) out << " \"" << world.name(body) << '"';
    out << ", " << to_string(world.type(body));
    if (world.is_quarantined(body)) out << ", quarantined";
    out << "\n  shapes           ";
    for (const ShapeId shape : world.shapes(body)) out << ' ' << to_string(type_of(world.shape(shape)));
    const Pose pose = world.pose(body);
    out << "\n  position          " << pose.position << " m\n  orientation       (w " << pose.orientation.w << ", x "
        << pose.orientation.x << ", y " << pose.orientation.y << ", z " << pose.orientation.z
        << ")\n  linear velocity   " << world.linear_velocity(body) << " m/s\n  angular velocity  "
        << world.angular_velocity(body) << " rad/s\n";
    if (world.type(body) == BodyType::Dynamic) out << "  mass              " << world.mass_properties(body).mass << " kg\n";
    return out.str();
}

}  // namespace carom
