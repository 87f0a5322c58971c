// Boxes that move, come and go at random, with the oracle's pairs and events beside the broadphase's.
//
//   Crowd crowd(Distribution::Clustered, 300, seed);
//   crowd.change(random); crowd.check(broadphase, executor);
#pragma once

#include "broadphase/distributions.hpp"

#include <carom/broadphase/broadphase.hpp>
#include <carom/core/check.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>

namespace carom::test {

class Crowd {
public:
    Crowd(Distribution kind, std::size_t n, std::uint64_t seed, bool filtered)
        : kind_(kind),
          boxes_(random_boxes(kind, n, seed)),
          filters_(filtered ? random_filters(n, seed) : std::vector<ProxyFilter>(n)),
          alive_(n, true) {
        for (std::uint32_t i = 0; i < n; ++i) moved_.push_back(i);
    }

    /// A share of the live boxes moves, a little or far; some go and some come back elsewhere, some change filters.
    void change(Random& random, double moving, double churn) {
        moved_.clear();
        removed_.clear();
        for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
            if (alive_[i] && random.unit() < moving) {
                const double step = random.unit() < 0.05 ? 5.0 : 0.05;
                const vec3 by(dvec3{random.range(-step, step), random.range(-step, step), random.range(-step, step)});
                boxes_[i].lower += by;
                boxes_[i].upper += by;
                moved_.push_back(i);
                if (random.unit() < 0.02) moved_.push_back(i);  // repeats are harmless
            } else if (random.unit() < churn) {
                if (alive_[i]) {
                    removed_.push_back(i);
                } else {
                    boxes_[i] = random_box(kind_, random, i);
                    moved_.push_back(i);
                }
                alive_[i] = !alive_[i];
            } else if (alive_[i] && random.unit() < churn) {
                filters_[i].mask ^= std::uint64_t{1} << static_cast<unsigned>(random.range(0, 4));
                filters_[i].movable = random.unit() < 0.7;
                moved_.push_back(i);
            }
        }
        std::reverse(moved_.begin(), moved_.end());  // no order is promised
    }
    /// Every box goes, or every box comes.
    void all_at_once(bool come) {
        moved_.clear();
        removed_.clear();
        for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
            if (alive_[i] != come) (come ? moved_ : removed_).push_back(i);
            alive_[i] = come;
        }
    }

    [[nodiscard]] ProxyChanges changes() const { return {boxes_, filters_, moved_, removed_}; }
    [[nodiscard]] std::vector<ProxyPair> oracle() const {
        std::vector<ProxyPair> pairs = all_pairs(boxes_, filters_);
        std::erase_if(pairs, [&](const ProxyPair& pair) { return !alive_[pair.a] || !alive_[pair.b]; });
        return pairs;
    }

    /// Updates and compares pairs and events.
    void check(Broadphase& broadphase, Executor& executor) {
        const PairUpdate& found = broadphase.update(changes(), executor);
        const std::vector<ProxyPair> want = oracle();
        ASSERT_EQ(std::vector<ProxyPair>(found.pairs.begin(), found.pairs.end()), want);
        std::vector<ProxyPair> begun, ended;
        std::set_difference(want.begin(), want.end(), before_.begin(), before_.end(), std::back_inserter(begun));
        std::set_difference(before_.begin(), before_.end(), want.begin(), want.end(), std::back_inserter(ended));
        ASSERT_EQ(std::vector<ProxyPair>(found.begun.begin(), found.begun.end()), begun);
        ASSERT_EQ(std::vector<ProxyPair>(found.ended.begin(), found.ended.end()), ended);
        ASSERT_EQ(found.status, PairStatus::Complete);
        ASSERT_EQ(broadphase.live_count(), static_cast<std::size_t>(std::count(alive_.begin(), alive_.end(), true)));
        before_ = want;
    }

    void move_by(std::uint32_t i, const vec3& by) {
        if (!alive_[i]) return;
        boxes_[i].lower += by;
        boxes_[i].upper += by;
        moved_.push_back(i);
    }
    /// A live box becomes another one; a free slot comes alive with it.
    void place(std::uint32_t i, const FloatAabb& box) {
        boxes_[i] = box;
        alive_[i] = true;
        moved_.push_back(i);
    }
    /// Not in an update in which the slot is placed.
    void take_out(std::uint32_t i) {
        if (!alive_[i] || std::find(moved_.begin(), moved_.end(), i) != moved_.end()) return;
        alive_[i] = false;
        removed_.push_back(i);
    }
    /// Begins the next list of changes.
    void rest() {
        moved_.clear();
        removed_.clear();
    }
    [[nodiscard]] std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(boxes_.size()); }
    [[nodiscard]] bool is_alive(std::uint32_t i) const { return alive_[i]; }
    [[nodiscard]] const FloatAabb& box(std::uint32_t i) const { return boxes_[i]; }
    /// Changes that must be refused: one of them has a bound that is not a number. The crowd stays as it is.
    void refuse_nan(Broadphase& broadphase, Executor& executor, std::uint32_t i, int axis) const {
        std::vector<FloatAabb> bad = boxes_;
        for (FloatAabb& box : bad) box.upper += 1.0f;
        bad[i].lower[axis] = std::numeric_limits<float>::quiet_NaN();
        std::vector<std::uint32_t> all(bad.size());
        std::iota(all.begin(), all.end(), 0u);
        const std::vector<ProxyPair> pairs(broadphase.result().pairs.begin(), broadphase.result().pairs.end());
        const std::size_t live = broadphase.live_count();
        EXPECT_THROW(broadphase.update({bad, filters_, all, {}}, executor), MisuseError);
        EXPECT_TRUE(std::equal(pairs.begin(), pairs.end(), broadphase.result().pairs.begin(), broadphase.result().pairs.end()));
        EXPECT_EQ(broadphase.live_count(), live);
    }
    /// About its lower corner, up to a size of 1e6 m.
    void scale(std::uint32_t i, float factor) {
        if (!alive_[i] || boxes_[i].upper.x - boxes_[i].lower.x > 1e6f) return;
        boxes_[i].upper = boxes_[i].lower + factor * (boxes_[i].upper - boxes_[i].lower);
        moved_.push_back(i);
    }

private:
    Distribution kind_;
    std::vector<FloatAabb> boxes_;
    std::vector<ProxyFilter> filters_;
    std::vector<bool> alive_;
    std::vector<std::uint32_t> moved_, removed_;
    std::vector<ProxyPair> before_;
};

}  // namespace carom::test
