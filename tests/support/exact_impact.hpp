// When a vertex meets a face, or two edges each other, exactly: the oracle of deforming_triangles.hpp.
//
//   const exact::FirstMeeting truth = exact::first_meeting(motion);
//   if (truth.verdict == exact::Verdict::Meet) EXPECT_TRUE(exact::number(impact.t) <= truth.latest);
//
// The four corners are in one plane at the roots of a cubic with rational coefficients, which Sturm's theorem isolates; whether the
// features meet there is the sign of polynomials at these roots, exact too: a sign that does not settle as the interval shrinks is zero
// if and only if the two polynomials share the root.
#pragma once

#include <carom/narrowphase/deforming_triangles.hpp>

#include <support/exact_distance.hpp>

#include <array>
#include <vector>

namespace carom::exact {

/// Coefficients, the constant first; no trailing zeros, so that zero is empty.
struct Polynomial {
    std::vector<Rational> c;

    Polynomial() = default;
    explicit Polynomial(std::vector<Rational> coefficients) : c(std::move(coefficients)) {
        while (!c.empty() && c.back().sign() == 0) c.pop_back();
    }
    [[nodiscard]] bool zero() const { return c.empty(); }
    [[nodiscard]] Rational at(const Rational& t) const {
        Rational sum = 0;
        for (std::size_t i = c.size(); i-- > 0;) sum = sum * t + c[i];
        return sum;
    }
    friend Polynomial operator+(const Polynomial& a, const Polynomial& b) {
        std::vector<Rational> sum(std::max(a.c.size(), b.c.size()), Rational(0));
        for (std::size_t i = 0; i < a.c.size(); ++i) sum[i] += a.c[i];
        for (std::size_t i = 0; i < b.c.size(); ++i) sum[i] += b.c[i];
        return Polynomial(sum);
    }
    friend Polynomial operator-(const Polynomial& a) { return Rational(-1) * a; }
    friend Polynomial operator-(const Polynomial& a, const Polynomial& b) { return a + -b; }
    friend Polynomial operator*(const Rational& s, const Polynomial& a) {
        std::vector<Rational> product = a.c;
        for (Rational& x : product) x *= s;
        return Polynomial(product);
    }
    friend Polynomial operator*(const Polynomial& a, const Polynomial& b) {
        if (a.zero() || b.zero()) return {};
        std::vector<Rational> product(a.c.size() + b.c.size() - 1, Rational(0));
        for (std::size_t i = 0; i < a.c.size(); ++i) {
            for (std::size_t j = 0; j < b.c.size(); ++j) product[i + j] += a.c[i] * b.c[j];
        }
        return Polynomial(product);
    }
    [[nodiscard]] Polynomial slope() const {
        std::vector<Rational> d;
        for (std::size_t i = 1; i < c.size(); ++i) d.push_back(Rational(i) * c[i]);
        return Polynomial(d);
    }
};

/// @return the quotient and the remainder of a / b; b is not zero.
inline std::pair<Polynomial, Polynomial> divide(Polynomial a, const Polynomial& b) {
    std::vector<Rational> quotient(a.c.size() >= b.c.size() ? a.c.size() - b.c.size() + 1 : 0, Rational(0));
    while (a.c.size() >= b.c.size()) {
        const std::size_t shift = a.c.size() - b.c.size();
        const Rational factor = a.c.back() / b.c.back();
        quotient[shift] = factor;
        for (std::size_t i = 0; i < b.c.size(); ++i) a.c[shift + i] -= factor * b.c[i];
        a = Polynomial(a.c);
    }
    return {Polynomial(quotient), a};
}
inline Polynomial common_divisor(Polynomial a, Polynomial b) {
    while (!b.zero()) {
        Polynomial rest = divide(a, b).second;
        a = b;
        b = rest.zero() ? rest : Rational(1 / rest.c.back()) * rest;
    }
    return a;
}

/// How many roots a polynomial without multiple roots has in (from, to] (Sturm).
class RootCounter {
public:
    RootCounter() = default;
    explicit RootCounter(const Polynomial& p) {
        chain_ = {p, p.slope()};
        while (!chain_.back().zero()) {
            const Polynomial rest = divide(chain_[chain_.size() - 2], chain_.back()).second;
            chain_.push_back(rest.zero() ? rest : Rational(-1 / magnitude(rest.c.back())) * rest);
        }
        chain_.pop_back();
    }
    [[nodiscard]] int in(const Rational& from, const Rational& to) const { return changes(from) - changes(to); }

private:
    [[nodiscard]] int changes(const Rational& t) const {
        int count = 0, last = 0;
        for (const Polynomial& p : chain_) {
            const int s = p.at(t).sign();
            if (s != 0 && last != 0 && s != last) ++count;
            if (s != 0) last = s;
        }
        return count;
    }
    std::vector<Polynomial> chain_;
};

inline Polynomial without_multiple_roots(const Polynomial& p) { return divide(p, common_divisor(p, p.slope())).first; }

/// A root of `p`, which has no multiple ones: the only one in (from, to].
struct Root {
    Polynomial p;
    RootCounter counter;
    Rational from, to;

    void halve() {
        const Rational middle = (from + to) / 2;
        (counter.in(from, middle) > 0 ? to : from) = middle;
    }
    /// @return the sign of q here.
    [[nodiscard]] int sign_of(const Polynomial& q) {
        if (q.zero()) return 0;
        if (p.at(to).sign() == 0) return q.at(to).sign();
        const Polynomial shared = common_divisor(p, q);
        if (shared.c.size() > 1 && RootCounter(shared).in(from, to) > 0) return 0;
        const RootCounter roots(without_multiple_roots(q));
        while (roots.in(from, to) > 0) {
            halve();
            if (p.at(to).sign() == 0) return q.at(to).sign();
        }
        return q.at(to).sign();
    }
};

/// @return the roots in [0, 1], in order.
inline std::vector<Root> roots_of(const Polynomial& any) {
    const Polynomial p = without_multiple_roots(any);
    const RootCounter counter(p);
    std::vector<Root> roots;
    const auto look = [&](auto&& self, const Rational& from, const Rational& to) -> void {
        const int count = counter.in(from, to);
        if (count == 1) roots.push_back({p, counter, from, to});
        if (count > 1) {
            const Rational middle = (from + to) / 2;
            self(self, from, middle);
            self(self, middle, to);
        }
    };
    if (p.c.size() > 1) look(look, -1, 1);
    std::erase_if(roots, [&](Root& r) {
        if (r.from.sign() >= 0) return false;
        return r.sign_of(Polynomial({Rational(0), Rational(1)})) < 0;
    });
    return roots;
}

enum class Verdict { Apart, Meet, Unknown };
struct FirstMeeting {
    Verdict verdict = Verdict::Apart;  ///< Unknown: in one plane all the time, or without a plane when it counts
    Rational latest = 1;               ///< the first meeting is at most this late, and at most 2^-60 earlier
};

struct MovingVec {
    std::array<Polynomial, 3> k;
};
inline MovingVec moving(const Vec& start, const Vec& end) {
    MovingVec v;
    for (int i = 0; i < 3; ++i) v.k[static_cast<std::size_t>(i)] = Polynomial({start[i], Rational(end[i] - start[i])});
    return v;
}
inline MovingVec operator-(const MovingVec& a, const MovingVec& b) { return {{a.k[0] - b.k[0], a.k[1] - b.k[1], a.k[2] - b.k[2]}}; }
inline Polynomial dot(const MovingVec& a, const MovingVec& b) { return a.k[0] * b.k[0] + a.k[1] * b.k[1] + a.k[2] * b.k[2]; }
inline MovingVec cross(const MovingVec& a, const MovingVec& b) {
    return {{a.k[1] * b.k[2] - a.k[2] * b.k[1], a.k[2] * b.k[0] - a.k[0] * b.k[2], a.k[0] * b.k[1] - a.k[1] * b.k[0]}};
}

/// When d0 + s p + r q with p = d1 - d0, q = d2 - d0 is first zero for s, r >= 0 with s + r <= 1, or s, r <= 1 each.
inline FirstMeeting first_zero(const MovingVec& d0, const MovingVec& d1, const MovingVec& d2, bool parallelogram) {
    const MovingVec p = d1 - d0, q = d2 - d0, n = cross(p, q);
    const Polynomial height = dot(d0, n), nn = dot(n, n);
    if (height.zero()) return {Verdict::Unknown, 1};
    const Polynomial s = dot(cross(q, d0), n), r = dot(cross(d0, p), n);
    const std::vector<Polynomial> inside =
        parallelogram ? std::vector<Polynomial>{s, r, nn - s, nn - r} : std::vector<Polynomial>{s, r, nn - s - r};
    for (Root& root : roots_of(height)) {
        if (root.sign_of(nn) == 0) return {Verdict::Unknown, 1};
        bool met = true;
        for (const Polynomial& side : inside) met = met && root.sign_of(side) >= 0;
        if (!met) continue;
        while (root.p.at(root.to).sign() != 0 && root.to - root.from > Rational(0x1p-60)) root.halve();
        return {Verdict::Meet, root.to};
    }
    return {};
}

inline MovingVec gap(const MovingPoint& a, const MovingPoint& b) { return moving(vec(a.start) - vec(b.start), vec(a.end) - vec(b.end)); }
inline FirstMeeting first_meeting(const VertexFaceMotion& m) {
    return first_zero(gap(m.vertex, m.face[0]), gap(m.vertex, m.face[1]), gap(m.vertex, m.face[2]), false);
}
inline FirstMeeting first_meeting(const EdgeEdgeMotion& m) {
    return first_zero(gap(m.a[0], m.b[0]), gap(m.a[0], m.b[1]), gap(m.a[1], m.b[0]), true);
}

inline Vec place(const MovingPoint& p, const Rational& t) { return vec(p.start) + t * (vec(p.end) - vec(p.start)); }
/// The squared distance of the two features at t.
inline Rational distance_sq_at(const VertexFaceMotion& m, const Rational& t) {
    return distance_sq(place(m.vertex, t), place(m.face[0], t), place(m.face[1], t), place(m.face[2], t));
}
inline Rational distance_sq_at(const EdgeEdgeMotion& m, const Rational& t) {
    const Vec a = place(m.a[0], t), b = place(m.b[0], t);
    return detail::segments_sq(a, place(m.a[1], t) - a, b, place(m.b[1], t) - b);
}

}  // namespace carom::exact
