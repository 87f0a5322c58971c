#include <carom/dynamics/detail/body_path.hpp>

#include <carom/core/math.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace carom::dynamics {
namespace {

constexpr int kMostHalvings = 14;
constexpr double kNoAxis = 1e-12;       // below this sine of half an angle the axis is that of the spin
constexpr double kRoundShare = 0.125;   // of the bend that is let be: what is less out of round is round
constexpr double kTurnRounding = 0x1p-49;  // of a turn, and of an angle: by what rounding changes them, here and where the piece is cut

dquat conjugate(const dquat& q) noexcept { return {q.w, -q.x, -q.y, -q.z}; }

/// The rotation vector that takes one orientation to the other, of those that differ by whole turns the one nearest to `about`.
dvec3 turn_between(const dquat& from, const dquat& to, const dvec3& about) noexcept {
    if (from == to && about == dvec3{0.0}) return dvec3{0.0};
    const dquat between = to * conjugate(from);
    const dvec3 imaginary{between.x, between.y, between.z};
    const double sine = glm::length(imaginary);
    dvec3 axis;
    double angle = 0.0;
    if (sine > kNoAxis) {
        axis = imaginary / sine;
        angle = 2.0 * arctan2(sine, between.w);
    } else {
        const double length = glm::length(about);
        if (length == 0.0) return dvec3{0.0};
        axis = about / length;
    }
    return axis * (angle + 2.0 * kPi * std::floor((glm::dot(about, axis) - angle) / (2.0 * kPi) + 0.5));
}

/// A bound of how fast the spin of a free body changes [rad/s²]. Euler's equations, with each component of the spin at the largest that energy and
/// angular momentum allow.
double most_spin_change(const BodyState& state, const BodyMass& mass, const FreeMotion& motion, double time) noexcept {
    if (mass.mass == 0.0) return 0.0;
    if (mass.inertia == InertiaClass::Isotropic && motion.torque == dvec3{0.0} && motion.angular_damping == 0.0) return 0.0;
    const dvec3 &moment = mass.moments, &inverse = mass.inverse_moments, spin = rotate_inverse(state.pose.orientation, state.spin), momentum = moment * spin;
    const double torque = glm::length(motion.torque), most_inverse = std::max({inverse.x, inverse.y, inverse.z});
    const double root = std::sqrt(glm::dot(momentum, spin)) + torque * time * std::sqrt(most_inverse), length = glm::length(momentum) + torque * time;
    const double twice_energy = root * root, square = length * length;
    const double pushed = torque * most_inverse + motion.angular_damping * glm::length(spin);
    if (std::popcount(static_cast<unsigned>(mass.locked & kLockedTurns)) == 2) return pushed;  // about one axis of the world its moment stays
    if ((mass.locked & kLockedTurns) != 0 && mass.inertia != InertiaClass::Isotropic) {
        return pushed + square * most_inverse * most_inverse * std::max({moment.x, moment.y, moment.z}) * most_inverse;
    }
    if (mass.inertia == InertiaClass::Isotropic) return pushed;
    dvec3 most{0.0}, change{0.0};
    for (int i = 0; i < 3; ++i) most[i] = std::sqrt(std::min(twice_energy * inverse[i], square * inverse[i] * inverse[i]));
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        change[i] = std::abs(moment[j] - moment[k]) * inverse[i] * most[j] * most[k];
    }
    if (mass.inertia == InertiaClass::Symmetric && torque == 0.0) {  // its share along the axis stays, and so does the rest's length
        const int i = mass.axis, j = (i + 1) % 3, k = (i + 2) % 3;
        return pushed + std::abs(moment[i] - moment[j]) * inverse[j] * std::abs(spin[i]) * std::sqrt(spin[j] * spin[j] + spin[k] * spin[k]);
    }
    return pushed + glm::length(change);
}

/// Whether a body's axis turns about its angular momentum and at an even rate, and nothing is seen of how it turns about that axis.
bool turns_evenly(const BodyState& state, const BodyMass& mass, const FreeMotion& motion, const PathSettings& settings) noexcept {
    if (mass.mass == 0.0 || mass.inertia != InertiaClass::Symmetric || (mass.locked & kLockedTurns) != 0) return false;
    if (motion.torque != dvec3{0.0} || motion.angular_damping != 0.0 || glm::length(state.spin) * settings.dt > kMostTurn) return false;
    return settings.out_of_round[mass.axis] <= kRoundShare * settings.most_bend;
}

/// The rate at which the axis of a symmetric body turns [rad/s].
dvec3 rate_of_axis(const BodyState& state, const BodyMass& mass) noexcept {
    const dvec3 momentum = mass.moments * rotate_inverse(state.pose.orientation, state.spin);
    return mass.inverse_moments[(mass.axis + 1) % 3] * rotate(state.pose.orientation, momentum);
}

dvec3 axis_of(const BodyState& state, const BodyMass& mass) noexcept {
    dvec3 own{0.0};
    own[mass.axis] = 1.0;
    return rotate(state.pose.orientation, own);
}

/// Written where it stays: numbers that have just been stored one by one are slow to copy.
void lay_chord(const Pose& from, const Pose& to, const dvec3& turning, PathPiece& piece) noexcept {
    piece.start = from;
    piece.translation = to.position - from.position;
    piece.rotation = turn_between(from.orientation, to.orientation, turning);
}

}  // namespace

PathPiece chord(const Pose& from, const Pose& to, const dvec3& turning) noexcept {
    PathPiece piece;
    lay_chord(from, to, turning, piece);
    return piece;
}

void BodyPath::fly(const Flight& flight, const BodyMass& mass, double begin, const PathSettings& settings, const BodyState* arrived) {
    flight_ = flight;
    mass_ = &mass;
    rides_ = false;
    settings_ = settings;
    const FreeMotion& motion = flight.motion;
    const double pull = glm::length(motion.acceleration);
    most_pull_ = pull + motion.linear_damping * (glm::length(flight.start.velocity) + pull * settings.dt);
    most_change_ = most_spin_change(flight.start, mass, motion, settings.dt);
    is_round_ = turns_evenly(flight.start, mass, motion, settings);
    nodes_.clear();
    add(flight.start, arrived != nullptr ? *arrived : after(flight.start, 1.0 - begin), begin, 1.0, 0);
}

void BodyPath::go(const PathPiece& piece) {
    mass_ = nullptr;
    rides_ = false;
    nodes_.clear();
    nodes_.push_back({.piece = piece, .from = {}, .to = {}});
}

void BodyPath::ride(const Ride& ride, double begin, const PathSettings& settings) {
    ride_ = ride;
    mass_ = nullptr;
    rides_ = true;
    settings_ = settings;
    nodes_.clear();
    add_ride(begin, 1.0, 0);
}

// The centre of mass goes round the carrier's, whose way is straight: from the chord it comes by no more than (angle)² / 8 of the radius, nor than twice that.
void BodyPath::add_ride(double begin, double end, int depth) {
    Node& node = nodes_.emplace_back();
    node.from = {}, node.to = {};
    node.depth = depth;
    PathPiece& piece = node.piece;
    piece.begin = begin, piece.end = end;
    piece.start = dynamics::pose_at(ride_.carrier, begin) * ride_.local;
    piece.translation = (dynamics::pose_at(ride_.carrier, end) * ride_.local).position - piece.start.position;
    piece.rotation = (end - begin) * ride_.carrier.rotation;
    const double turn = glm::length(piece.rotation);
    piece.sway = glm::length(ride_.local.position) * std::min(2.0, turn * turn / 8.0);
    piece.bend = piece.sway + ride_.carrier.bend;
}

BodyState BodyPath::after(BodyState state, double share) const noexcept {
    integrate_free(state, *mass_, flight_.motion, share * settings_.dt);
    return state;
}

// Both ends of the screw are the integrator's. From either the turn differs from the screw's by no more than the integral of the difference of the two
// angular velocities, and the nearer end is at most half the time away.
void BodyPath::add(const BodyState& from, const BodyState& to, double begin, double end, int depth) {
    const double time = (end - begin) * settings_.dt;
    Node& node = nodes_.emplace_back();
    node.from = from, node.to = to;
    node.depth = depth;
    PathPiece& piece = node.piece;
    piece.begin = begin, piece.end = end;
    piece.sway = most_pull_ * time * time / 8.0;
    if (is_round_) {
        piece.start = from.pose;
        piece.translation = to.pose.position - from.pose.position;
        piece.rotation = time * rate_of_axis(from, *mass_);
        const double off = glm::length(rotate(rotation_from_vector(piece.rotation), axis_of(from, *mass_)) - axis_of(to, *mass_));
        piece.bend = piece.sway + 2.0 * settings_.out_of_round[mass_->axis] + settings_.reach * (off + kTurnRounding * (1.0 + glm::length(piece.rotation)));
        return;
    }
    lay_chord(from.pose, to.pose, 0.5 * time * (from.spin + to.spin), piece);
    const double differ = std::max(glm::length(time * from.spin - piece.rotation), glm::length(time * to.spin - piece.rotation));
    piece.bend = piece.sway + settings_.reach * std::min(2.0, 0.5 * differ + most_change_ * time * time / 8.0);
}

bool BodyPath::can_split(std::uint32_t number) const noexcept {
    const Node& node = nodes_[number];
    return (rides_ ? node.piece.sway : mass_ != nullptr ? node.piece.bend : 0.0) > settings_.most_bend && node.depth < kMostHalvings;
}

std::pair<std::uint32_t, std::uint32_t> BodyPath::split(std::uint32_t number) {
    if (nodes_[number].halves == 0) {
        const Node node = nodes_[number];
        const double middle = 0.5 * (node.piece.begin + node.piece.end);
        nodes_[number].halves = static_cast<std::uint32_t>(nodes_.size());
        if (rides_) {
            add_ride(node.piece.begin, middle, node.depth + 1);
            add_ride(middle, node.piece.end, node.depth + 1);
            return {nodes_[number].halves, nodes_[number].halves + 1};
        }
        const BodyState midway = after(node.from, middle - node.piece.begin);
        add(node.from, midway, node.piece.begin, middle, node.depth + 1);
        add(midway, node.to, middle, node.piece.end, node.depth + 1);
    }
    const std::uint32_t first = nodes_[number].halves;
    return {first, first + 1};
}

BodyState Ride::motion(double t, double dt) const noexcept {
    const Pose other = dynamics::pose_at(carrier, t), pose = other * local;
    const dvec3 spin = carrier.rotation / dt;
    return {pose, carrier.translation / dt + glm::cross(spin, pose.position - other.position), spin};
}

BodyState Ride::after(const BodyState& start, double since, double t, double dt) const noexcept {
    const dquat turn = rotation_from_vector((t - since) * carrier.rotation);
    const dvec3 along = carrier.translation / dt;
    return {dynamics::pose_at(carrier, t) * local, along + rotate(turn, start.velocity - along), rotate(turn, start.spin)};
}

Aabb BodyPath::box(double reach) const noexcept { return box_of(piece(kWhole), reach); }

Pose pose_at(const PathPiece& piece, double t) noexcept {
    const double span = piece.end - piece.begin, share = span > 0.0 ? (t - piece.begin) / span : 0.0;
    Pose pose = piece.start;
    pose.position += share * piece.translation;
    if (piece.rotation != dvec3{0.0}) pose.orientation = glm::normalize(rotation_from_vector(share * piece.rotation) * pose.orientation);
    return pose;
}

PathPiece cut(const PathPiece& piece, double begin, double end) noexcept {
    if (begin == piece.begin && end == piece.end) return piece;
    const double span = piece.end - piece.begin, share = span > 0.0 ? (end - begin) / span : 0.0;
    return {begin, end, pose_at(piece, begin), share * piece.translation, share * piece.rotation, piece.sway, piece.bend};
}

RigidMotion shape_motion(const PathPiece& piece, const Pose& local) noexcept {
    return {.start = piece.start * local,
            .translation = piece.translation,
            .rotation = piece.rotation,
            .pivot = rotate_inverse(local.orientation, -local.position)};
}

Aabb box_of(const PathPiece& piece, double reach) noexcept {
    const dvec3 from = piece.start.position, to = from + piece.translation;
    return inflate({glm::min(from, to), glm::max(from, to)}, reach + piece.sway);
}

}  // namespace carom::dynamics
