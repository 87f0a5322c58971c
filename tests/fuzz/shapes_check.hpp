// What must hold for any cylinder, cone or compound of raw bits against any other shape: a typed refusal, or bounds, mass, rays and contacts
// that are finite and agree with exact supports. For the fuzzer and for tests.
//
//   EXPECT_EQ(test::shapes_fault(bytes), "");
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/collision/compound.hpp>
#include <carom/collision/mass_properties.hpp>
#include <carom/collision/ray_cast.hpp>
#include <carom/core/random.hpp>
#include <carom/narrowphase/collide.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace carom::test {

/// Reads bytes as numbers, in the way that the first byte says. Zeros once they are used up.
class RawBytes {
public:
    enum class Style {
        Raw,   ///< any bits: NaN, infinities, denormals; the shapes of a scene seldom have anything to do with each other
        Wide,  ///< numbers of all bits about one scale between 2^-96 and 2^95
        Tame,  ///< numbers of everyday size and few bits, where ties are common
    };
    [[nodiscard]] static Style style_of(std::span<const std::uint8_t> bytes) {
        const int first = bytes.empty() ? 0 : bytes[0] % 4;
        return first == 0 ? Style::Raw : first == 1 ? Style::Wide : Style::Tame;
    }
    explicit RawBytes(std::span<const std::uint8_t> bytes) : bytes_(bytes), style_(style_of(bytes)) {
        byte();
        if (style_ == Style::Wide) scale_ = std::ldexp(1.0, 3 * static_cast<std::int8_t>(byte()) / 4);
    }
    std::uint8_t byte() {
        if (bytes_.empty()) return 0;
        const std::uint8_t b = bytes_[0];
        bytes_ = bytes_.subspan(1);
        return b;
    }
    template <class T>
    T raw() {
        std::array<std::uint8_t, sizeof(T)> bits{};
        for (std::uint8_t& b : bits) b = byte();
        return std::bit_cast<T>(bits);
    }
    float size() {
        if (style_ == Style::Raw) return raw<float>();
        if (style_ == Style::Wide) {
            const std::uint32_t bits = raw<std::uint32_t>();
            return static_cast<float>(scale_ * std::ldexp(static_cast<double>(1 + (bits >> 8)), -24 - static_cast<int>(bits % 8)));
        }
        const std::uint16_t bits = raw<std::uint16_t>();
        const float scales[] = {1.0f, 0.1f, 0.01f, 0.001f};
        return scales[bits % 4] * static_cast<float>(1 + bits / 4 % 64) / 64.0f;
    }
    double coordinate() { return style_ == Style::Raw ? raw<double>() : scale_ * number(); }
    Pose pose() {
        Pose p{{coordinate(), coordinate(), coordinate()}};
        if (byte() % 4 == 0) return p;
        const auto part = [&] { return style_ == Style::Raw ? raw<double>() : number(); };
        const dquat q{part(), part(), part(), part()};
        const double length = glm::length(q);
        if (length > 1e-3 && length < 1e3) p.orientation = q / length;
        return p;
    }
    /// Up to 2^31 times the scale, or nothing: where a scene stands. Wide only.
    dvec3 far() {
        const int how = style_ == Style::Wide ? byte() % 64 : 32;
        if (how >= 32) return dvec3{0.0};
        const double x = number(), y = number();
        return scale_ * std::ldexp(1.0, how) * dvec3{x, y, number()};
    }

private:
    /// Of [-2, 2).
    double number() {
        return style_ == Style::Wide ? std::ldexp(static_cast<double>(raw<std::int32_t>()), -30) : static_cast<double>(raw<std::int16_t>()) / 16384.0;
    }

    std::span<const std::uint8_t> bytes_;
    Style style_;
    double scale_ = 1.0;
};

inline Shape draw_convex(RawBytes& bytes) {
    switch (bytes.byte() % 5) {
        case 0: return Cylinder{bytes.size(), bytes.size()};
        case 1: return Cone{bytes.size(), bytes.size()};
        case 2: return Sphere{bytes.size()};
        case 3: return Box{{bytes.size(), bytes.size(), bytes.size()}};
        default: return Capsule{bytes.size(), bytes.size()};
    }
}

/// @return null where Compound::build() refuses.
inline CompoundPtr draw_compound(RawBytes& bytes) {
    std::vector<CompoundPart> parts;
    for (int i = bytes.byte() % 4; i >= 0; --i) parts.push_back({draw_convex(bytes), bytes.pose()});
    Result<CompoundPtr> made = Compound::build(std::move(parts));
    return made ? *made : nullptr;
}

/// How far the convex shape reaches along the world direction `n` from `origin`.
inline long double reach_along(const Shape& shape, const Pose& pose, const dvec3& origin, const dvec3& n) {
    const glm::vec<3, long double> local(rotate_inverse(pose.orientation, n));
    const long double x = local.x, y = local.y, z = local.z, across = std::sqrt(x * x + z * z);
    long double own = 0;
    if (const Cylinder* c = std::get_if<Cylinder>(&shape)) own = c->radius * across + c->half_height * std::abs(y);
    if (const Cone* c = std::get_if<Cone>(&shape)) own = std::max<long double>(c->half_height * y, c->radius * across - c->half_height * y);
    if (const Sphere* s = std::get_if<Sphere>(&shape)) own = s->radius;
    if (const Capsule* c = std::get_if<Capsule>(&shape)) own = c->radius + c->half_segment * std::abs(y);
    if (const Box* b = std::get_if<Box>(&shape)) {
        own = b->half_extents.x * std::abs(x) + b->half_extents.y * std::abs(y) + b->half_extents.z * std::abs(z);
    }
    const dvec3 d = pose.position - origin;
    return own + static_cast<long double>(n.x) * d.x + static_cast<long double>(n.y) * d.y + static_cast<long double>(n.z) * d.z;
}

/// What is wrong with the manifolds of a pair.
inline std::string contact_fault(const Shape& a, const Pose& pa, const Shape& b, const Pose& pb, float margin, Random& random) {
    std::vector<Manifold> out;
    const CollideStatus status = collide(ShapePair{&a, &b, pa, pb, margin}, 0, out);
    const double size = std::max(bounding_radius(a), bounding_radius(b));
    if (size > 1e30) return "";  // more than a world takes: the floats of a manifold do not hold it
    for (const Manifold& m : out) {
        if (m.count < 1 || m.count > 4) return "a manifold without points, or with too many";
        const dvec3 n(m.normal);
        if (!(std::abs(glm::dot(n, n) - 1.0) < 1e-5)) return "a normal that is not of unit length";
        for (const ContactPoint& p : m.used()) {
            if (!is_finite(p.position) || !is_finite(p.separation)) return "a point that is not finite";
            if (!(p.separation <= margin * 1.0001f)) return "a point beyond the margin";
        }
    }
    const bool convex = !std::holds_alternative<CompoundPtr>(a) && !std::holds_alternative<CompoundPtr>(b);
    // Floats lose what is smaller than their least normal number, and a shape that is nothing next to the other, or a needle beyond what
    // cylinders may be, has no faces to speak of.
    const double thin = std::min(smallest_extent(a), smallest_extent(b));
    if (!convex || !(size > 1e-30) || thin < 1e-9 * size) return "";
    if (out.size() > 1) return "several manifolds of two convex shapes";
    const auto gap = [&](const dvec3& n) { return static_cast<double>(-reach_along(b, pb, pa.position, -n) - reach_along(a, pa, pa.position, n)); };
    double most = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < 200; ++i) {
        dvec3 n{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};
        if (glm::length(n) > 1e-3) most = std::max(most, gap(glm::normalize(n)));
    }
    // The margin may be much larger than the shapes: a separation is a float.
    const double tolerance = 1e-5 * size + 1e-6 * std::abs(most), reported = static_cast<double>(margin);
    if (out.empty()) {
        const dvec3 between = pb.position - pa.position;
        const bool near = glm::length(between) < 1e-3 * std::min(smallest_extent(a), smallest_extent(b));
        return near ? "shapes about one centre are reported as apart" : "";
    }
    float least = out[0].points[0].separation;
    for (const ContactPoint& p : out[0].used()) least = std::min(least, p.separation);
    const dvec3 normal = glm::normalize(dvec3(out[0].normal));
    if (std::abs(gap(normal) - static_cast<double>(least)) > tolerance) return "a separation that is not that along the normal";
    if (most > reported + tolerance) return "a contact of shapes that a direction shows to be apart";
    // Two boxes that are apart have a lower bound.
    const bool boxes = std::holds_alternative<Box>(a) && std::holds_alternative<Box>(b);
    if (status == CollideStatus::Ok && !boxes && most > static_cast<double>(least) + tolerance) return "a direction beats the normal";
    return "";
}

inline std::string solid_fault(const Shape& shape, const Pose& pose, const Ray& ray) {
    const Aabb box = bounds(shape, pose);
    if (is_finite(pose.position) && is_empty(box)) return "an empty box";
    if (!(bounding_radius(shape) > 0.0) || !(smallest_extent(shape) > 0.0)) return "a solid without extent";
    const Result<MassProperties> mass = mass_properties(shape, 1000.0);
    if (mass && !(mass->mass >= 0.0)) return "a negative mass";
    const std::optional<RayHit> hit = cast_ray(shape, pose, ray);
    if (!hit) return "";
    if (!is_finite(hit->point) || !is_finite(hit->normal) || !(hit->distance >= 0.0 && hit->distance <= ray.max_distance)) return "a hit that is none";
    if (!(std::abs(glm::length(hit->normal) - 1.0) < 1e-9)) return "a hit whose normal is not of unit length";
    const double slack = 1e-9 * (glm::length(ray.origin - pose.position) + bounding_radius(shape)) + 1e-12 * glm::length(pose.position);
    const Aabb wide = inflate(box, slack);
    if (!glm::all(glm::lessThanEqual(wide.lower, hit->point)) || !glm::all(glm::lessThanEqual(hit->point, wide.upper))) return "a hit outside the bounds";
    return "";
}

/// @return what is wrong with the answers to the scene that the bytes say; empty if nothing is.
inline std::string shapes_fault(std::span<const std::uint8_t> data) {
    RawBytes bytes(data);
    std::vector<Shape> shapes{draw_convex(bytes), draw_convex(bytes)};
    if (CompoundPtr compound = draw_compound(bytes)) shapes.push_back(std::move(compound));
    const Pose pa = bytes.pose(), pb = bytes.pose();
    const Ray ray{pa.position + dvec3{bytes.coordinate(), bytes.coordinate(), bytes.coordinate()},
                  {bytes.coordinate(), bytes.coordinate(), bytes.coordinate()}};
    Random random(data.size());
    for (const Shape& a : shapes) {
        if (!validate(a)) continue;
        if (!is_finite(pa) || !is_finite(pb)) continue;  // misuse, which the tests of collide() look at
        if (std::string fault = solid_fault(a, pa, ray); !fault.empty()) return std::string(to_string(type_of(a))) + ": " + fault;
        for (const Shape& b : shapes) {
            if (!validate(b)) continue;
            if (type_of(a) < ShapeType::Cylinder && type_of(b) < ShapeType::Cylinder) continue;  // others look at those
            std::string fault = contact_fault(a, pa, b, pb, 0.01f, random);
            if (!fault.empty()) return std::string(to_string(type_of(a))) + " against " + to_string(type_of(b)) + ": " + fault;
        }
    }
    return "";
}

}  // namespace carom::test
