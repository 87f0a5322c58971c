#include <carom/dynamics/detail/round_rows.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

constexpr double kSmallTurn = 0.005;  // [rad] in a step

}  // namespace

void RoundRows::list(const ProxySet& proxies, const BodyArrays& bodies, std::span<const std::int32_t> row_of_slot,
                     std::span<const unsigned char> leave_out, double dt) {
    rollers_.clear();
    for (const std::uint32_t slot : proxies.rollers) {
        const std::uint32_t body = proxies.bodies[slot];
        const auto row = static_cast<std::size_t>(row_of_slot[body]);  // no row is beyond the last
        if (row >= leave_out.size() || leave_out[row] != 0) continue;
        const BodyState& state = bodies.states[body];
        if (glm::dot(state.spin, state.spin) * (dt * dt) < kSmallTurn * kSmallTurn) continue;
        Roller& roller = rollers_.emplace_back();
        roller.row = row;
        roller.axis = rotate(state.pose.orientation, rotate(proxies.by_slot[slot].local.get().orientation, dvec3{0.0, 1.0, 0.0}));
        roller.turn[3] = 1.0f;
    }
}

void RoundRows::show(SolverBodies& rows) const noexcept {
    for (const Roller& roller : rollers_) std::copy(std::begin(roller.turn), std::end(roller.turn), rows.bodies[roller.row].turn);
}

// A turn is one about the axis and then one that swings the axis to where it goes, the shorter way.
void RoundRows::hide(SolverBodies& rows) noexcept {
    for (Roller& roller : rollers_) {
        float(&turn)[4] = rows.bodies[roller.row].turn;
        std::copy(std::begin(turn), std::end(turn), roller.turn);
        const dquat whole{turn[3], turn[0], turn[1], turn[2]};
        const double along = glm::dot(roller.axis, dvec3{whole.x, whole.y, whole.z}), length = std::sqrt(along * along + whole.w * whole.w);
        if (length == 0.0) continue;  // the axis has turned over: any twist would do
        const dvec3 about = (-along / length) * roller.axis;
        const dquat swing = whole * dquat{whole.w / length, about.x, about.y, about.z};
        turn[0] = static_cast<float>(swing.x), turn[1] = static_cast<float>(swing.y);
        turn[2] = static_cast<float>(swing.z), turn[3] = static_cast<float>(swing.w);
    }
}

}  // namespace carom::dynamics
