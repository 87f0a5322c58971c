#include <carom/bench/pair_finder.hpp>

#include <CGAL/Box_intersection_d/Box_d.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/version.h>

#include <algorithm>

namespace carom::bench {
namespace {

class CgalBox : public CGAL::Box_intersection_d::Box_d<float, 3, CGAL::Box_intersection_d::ID_NONE> {
public:
    CgalBox(FloatAabb box, std::uint32_t slot) : Box_d(&box.lower.x, &box.upper.x), slot_(slot) {}
    std::size_t id() const { return slot_; }

private:
    std::uint32_t slot_;
};

class CgalPairs final : public PairFinder {
public:
    explicit CgalPairs(std::span<const FloatAabb> boxes) { boxes_.reserve(boxes.size()); }
    std::string name() const override { return "cgal"; }
    std::string version() const override { return CGAL_VERSION_STR; }
    void update(std::span<const FloatAabb> boxes, std::span<const std::uint32_t>) override {
        boxes_.clear();
        for (std::uint32_t i = 0; i < boxes.size(); ++i) boxes_.emplace_back(boxes[i], i);
        found_.clear();
        CGAL::box_self_intersection_d(boxes_.begin(), boxes_.end(), [this](const CgalBox& a, const CgalBox& b) {
            const auto i = static_cast<std::uint32_t>(a.id()), j = static_cast<std::uint32_t>(b.id());
            found_.push_back({std::min(i, j), std::max(i, j)});
        });
    }
    std::vector<ProxyPair> pairs() const override { return found_; }

private:
    std::vector<CgalBox> boxes_;
    std::vector<ProxyPair> found_;
};

}  // namespace

std::unique_ptr<PairFinder> make_cgal_pairs(std::span<const FloatAabb> boxes) { return std::make_unique<CgalPairs>(boxes); }

}  // namespace carom::bench
