#include <carom/studies/oracle/exact_triangles.hpp>

#include <boost/multiprecision/cpp_int.hpp>

#include <algorithm>
#include <cstddef>

namespace carom::oracle {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using Vector = std::array<Rational, 3>;
using Triangle = std::array<Vector, 3>;

Vector exact(const dvec3& p) { return {Rational(p.x), Rational(p.y), Rational(p.z)}; }
Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Rational dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector edge(const Triangle& t, std::size_t k) { return t[(k + 1) % 3] - t[k]; }

bool separates(const Vector& axis, const Triangle& a, const Triangle& b) {
    const Rational a0 = dot(axis, a[0]), a1 = dot(axis, a[1]), a2 = dot(axis, a[2]);
    const Rational b0 = dot(axis, b[0]), b1 = dot(axis, b[1]), b2 = dot(axis, b[2]);
    return std::max({a0, a1, a2}) < std::min({b0, b1, b2}) || std::max({b0, b1, b2}) < std::min({a0, a1, a2});
}

}  // namespace

bool triangles_meet(const std::array<dvec3, 3>& first, const std::array<dvec3, 3>& second) {
    const Triangle a{exact(first[0]), exact(first[1]), exact(first[2])}, b{exact(second[0]), exact(second[1]), exact(second[2])};
    const Vector of_a = cross(edge(a, 0), edge(a, 1)), of_b = cross(edge(b, 0), edge(b, 1));
    if (separates(of_a, a, b) || separates(of_b, a, b)) return false;
    for (std::size_t i = 0; i < 3; ++i) {
        if (separates(cross(of_a, edge(a, i)), a, b) || separates(cross(of_b, edge(b, i)), a, b)) return false;
        for (std::size_t j = 0; j < 3; ++j) {
            if (separates(cross(edge(a, i), edge(b, j)), a, b)) return false;
        }
    }
    return true;
}

}  // namespace carom::oracle
