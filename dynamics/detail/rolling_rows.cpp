#include <carom/dynamics/detail/rolling_rows.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace carom::dynamics {
namespace {

constexpr std::uint32_t kNowhere = ~std::uint32_t{0};

dvec3 spin_of(const SolverBodies& rows, std::int32_t row) noexcept {
    const float* const spin = rows.bodies[static_cast<std::size_t>(row)].spin;
    return {spin[0], spin[1], spin[2]};
}

dvec3 turned(const SolverMass& mass, const dvec3& t) noexcept {
    const dvec3 diagonal{mass.diagonal[0], mass.diagonal[1], mass.diagonal[2]};
    const double xy = static_cast<double>(mass.others[0]), xz = static_cast<double>(mass.others[1]), yz = static_cast<double>(mass.others[2]);
    return {diagonal.x * t.x + xy * t.y + xz * t.z, xy * t.x + diagonal.y * t.y + yz * t.z, xz * t.x + yz * t.y + diagonal.z * t.z};
}

/// How easily the two turn against each other: about the normal, and at the most about any tangent.
struct Ease {
    double normal = 0.0, tangent = 0.0;
};

Ease ease_of(const SolverBodies& rows, std::int32_t a, std::int32_t b, const dvec3& n) noexcept {
    const auto both = [&](const dvec3& t) { return turned(rows.masses[static_cast<std::size_t>(a)], t) + turned(rows.masses[static_cast<std::size_t>(b)], t); };
    const dvec3 aside = std::abs(n.x) < 0.5 ? dvec3{1, 0, 0} : dvec3{0, 1, 0};
    const dvec3 t1 = glm::normalize(glm::cross(n, aside)), t2 = glm::cross(n, t1);
    const double k11 = glm::dot(t1, both(t1)), k22 = glm::dot(t2, both(t2)), k12 = glm::dot(t1, both(t2));
    const double mean = 0.5 * (k11 + k22), half = 0.5 * (k11 - k22);
    return {glm::dot(n, both(n)), mean + std::sqrt(half * half + k12 * k12)};
}

double inverse_or_zero(double x) noexcept { return x > 0.0 ? 1.0 / x : 0.0; }

}  // namespace

void RollingRows::find_lanes(const RollingInput& input) {
    place_.assign(input.contacts.manifolds.size(), kNowhere);
    for (std::uint32_t b = 0; b < input.bundles.size(); ++b) {
        for (std::uint32_t lane = 0; lane < kLanesPerBundle; ++lane) {
            const std::uint32_t m = input.bundles[b].manifold[lane];
            if (m != kUnusedLane) place_[m] = b * kLanesPerBundle + lane;
        }
    }
}

void RollingRows::list(const RollingInput& input, double h) {
    std::swap(rows_, before_);
    rows_.clear();
    const double scale = before_.empty() ? 1.0 : std::min(1.0, h / h_);  // as of the impulses: those of an impact do not grow with the step
    h_ = h;
    find_lanes(input);
    std::size_t old = 0;
    for (const ContactPair& pair : input.contacts.pairs) {
        const Resistance resistance = combine(input.proxies.by_slot[pair.proxy_a()].resistance, input.proxies.by_slot[pair.proxy_b()].resistance);
        if (!resists(resistance)) continue;
        for (std::uint32_t number = 0; number < pair.manifold_count; ++number) {
            const std::uint32_t place = place_[pair.first_manifold + number];
            if (place == kNowhere) continue;
            Row& row = rows_.emplace_back();
            row.key = pair.key;
            row.shape_a = pair.shape_a();
            row.shape_b = pair.shape_b();
            row.number = number;
            row.bundle = place / kLanesPerBundle;
            row.lane = place % kLanesPerBundle;
            const ContactBundle& bundle = input.bundles[row.bundle];
            row.a = bundle.row_a[row.lane];
            row.b = bundle.row_b[row.lane];
            row.normal = dvec3{input.contacts.manifolds[pair.first_manifold + number].normal};
            row.rolling = static_cast<double>(resistance.rolling);
            row.torsion = static_cast<double>(resistance.torsion);
            weigh(row, input.rows);
            const auto comes_before = [&](const Row& r) { return r.key != row.key ? r.key < row.key : r.number < number; };
            while (old < before_.size() && comes_before(before_[old])) ++old;
            if (old < before_.size() && before_[old].shape_a == row.shape_a && before_[old].shape_b == row.shape_b && before_[old].number == number) {
                row.impulse = scale * before_[old].impulse;
            }
        }
    }
}

void RollingRows::weigh(Row& row, const SolverBodies& rows) noexcept {
    const Ease ease = ease_of(rows, row.a, row.b, row.normal);
    row.rolling_mass = inverse_or_zero(ease.tangent);
    row.torsion_mass = inverse_or_zero(ease.normal);
}

void RollingRows::renew(const SolverBodies& rows, std::span<const unsigned char> changed) noexcept {
    for (Row& row : rows_) {
        if ((changed[static_cast<std::size_t>(row.a)] | changed[static_cast<std::size_t>(row.b)]) != 0) weigh(row, rows);
    }
}

void RollingRows::turn(SolverBodies& rows, const Row& row, const dvec3& impulse) noexcept {
    const auto add = [&](std::int32_t number, const dvec3& change) {
        if (number >= rows.movable) return;
        float* const spin = rows.bodies[static_cast<std::size_t>(number)].spin;
        for (int i = 0; i < 3; ++i) spin[i] = static_cast<float>(static_cast<double>(spin[i]) + change[i]);
    };
    add(row.a, -turned(rows.masses[static_cast<std::size_t>(row.a)], impulse));
    add(row.b, turned(rows.masses[static_cast<std::size_t>(row.b)], impulse));
}

void RollingRows::warm_start(SolverBodies& rows) const noexcept {
    for (const Row& row : rows_) turn(rows, row, row.impulse);
}

void RollingRows::solve(SolverBodies& rows, std::span<const ContactBundle> bundles) noexcept {
    for (Row& row : rows_) {
        double load = 0.0;
        const ContactBundle& bundle = bundles[row.bundle];
        for (const PointLanes& point : std::span{bundle.points, static_cast<std::size_t>(bundle.point_count)}) {
            load += static_cast<double>(point.normal_impulse[row.lane]);
        }
        const dvec3 spin = spin_of(rows, row.b) - spin_of(rows, row.a);
        const double about = glm::dot(spin, row.normal), old_about = glm::dot(row.impulse, row.normal);
        dvec3 roll = (row.impulse - old_about * row.normal) - row.rolling_mass * (spin - about * row.normal);
        const double most = row.rolling * load, length = glm::length(roll);
        if (length > most) roll *= most / length;
        const double twist = std::clamp(old_about - row.torsion_mass * about, -row.torsion * load, row.torsion * load);
        const dvec3 impulse = roll + twist * row.normal;
        turn(rows, row, impulse - row.impulse);
        row.impulse = impulse;
    }
}

void RollingRows::clear() noexcept {
    rows_.clear();
    before_.clear();
}

}  // namespace carom::dynamics
