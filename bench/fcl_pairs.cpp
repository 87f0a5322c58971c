#include <carom/bench/pair_finder.hpp>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/config.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision_object.h>

#include <algorithm>

namespace carom::bench {
namespace {

using Object = fcl::CollisionObject<double>;

fcl::Vector3<double> to_fcl(const vec3& v) { return {double(v.x), double(v.y), double(v.z)}; }

std::uint32_t slot_of(const Object& object) { return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(object.getUserData())); }

class FclPairs final : public PairFinder {
public:
    explicit FclPairs(std::span<const FloatAabb> boxes) {
        const auto shape = std::make_shared<fcl::Box<double>>(1.0, 1.0, 1.0);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            objects_.push_back(std::make_unique<Object>(shape));
            objects_.back()->setUserData(reinterpret_cast<void*>(i));
            place(i, boxes[i]);
            manager_.registerObject(objects_.back().get());
        }
        manager_.setup();
    }
    std::string name() const override { return "fcl"; }
    std::string version() const override { return FCL_VERSION; }
    void update(std::span<const FloatAabb> boxes, std::span<const std::uint32_t> moved) override {
        updated_.clear();
        for (const std::uint32_t i : moved) {
            place(i, boxes[i]);
            updated_.push_back(objects_[i].get());
        }
        if (moved.size() == objects_.size()) {
            manager_.update();  // refits the whole tree
        } else {
            manager_.update(updated_);
        }
        found_.clear();
        manager_.collide(&found_, [](Object* a, Object* b, void* found) {
            const std::uint32_t i = slot_of(*a), j = slot_of(*b);
            static_cast<std::vector<ProxyPair>*>(found)->push_back({std::min(i, j), std::max(i, j)});
            return false;
        });
    }
    std::vector<ProxyPair> pairs() const override { return found_; }

private:
    // Straight into the object: the way by a shape and a pose would round, and take longer.
    void place(std::size_t i, const FloatAabb& box) {
        const_cast<fcl::AABB<double>&>(objects_[i]->getAABB()) = {to_fcl(box.lower), to_fcl(box.upper)};
    }

    fcl::DynamicAABBTreeCollisionManager<double> manager_;
    std::vector<std::unique_ptr<Object>> objects_;
    std::vector<Object*> updated_;
    std::vector<ProxyPair> found_;
};

}  // namespace

std::unique_ptr<PairFinder> make_fcl_pairs(std::span<const FloatAabb> boxes) { return std::make_unique<FclPairs>(boxes); }

}  // namespace carom::bench
