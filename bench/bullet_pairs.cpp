#include <carom/bench/pair_finder.hpp>

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <LinearMath/btScalar.h>
#include <fmt/format.h>

namespace carom::bench {
namespace {

btVector3 to_bt(const vec3& v) { return {btScalar(v.x), btScalar(v.y), btScalar(v.z)}; }

class BulletPairs final : public PairFinder {
public:
    explicit BulletPairs(std::span<const FloatAabb> boxes) {
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            btBroadphaseProxy* proxy = broadphase_.createProxy(to_bt(boxes[i].lower), to_bt(boxes[i].upper), 0, nullptr,
                                                               btBroadphaseProxy::DefaultFilter, btBroadphaseProxy::AllFilter, nullptr);
            proxy->m_clientObject = reinterpret_cast<void*>(i);
            proxies_.push_back(proxy);
        }
        broadphase_.calculateOverlappingPairs(nullptr);
    }
    ~BulletPairs() override {
        for (btBroadphaseProxy* proxy : proxies_) broadphase_.destroyProxy(proxy, nullptr);
    }
    std::string name() const override { return "bullet"; }
    std::string version() const override { return fmt::format("{}.{}", btGetVersion() / 100, btGetVersion() % 100); }
    void update(std::span<const FloatAabb> boxes, std::span<const std::uint32_t> moved) override {
        for (const std::uint32_t i : moved) broadphase_.setAabb(proxies_[i], to_bt(boxes[i].lower), to_bt(boxes[i].upper), nullptr);
        broadphase_.calculateOverlappingPairs(nullptr);
    }
    std::vector<ProxyPair> pairs() const override {
        const btOverlappingPairCache& cache = *broadphase_.getOverlappingPairCache();
        std::vector<ProxyPair> out;
        for (int i = 0; i < cache.getNumOverlappingPairs(); ++i) {
            const btBroadphasePair& pair = cache.getOverlappingPairArrayPtr()[i];
            const auto a = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(pair.m_pProxy0->m_clientObject));
            const auto b = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(pair.m_pProxy1->m_clientObject));
            out.push_back({std::min(a, b), std::max(a, b)});
        }
        return out;
    }

private:
    mutable btDbvtBroadphase broadphase_;
    std::vector<btBroadphaseProxy*> proxies_;
};

}  // namespace

std::unique_ptr<PairFinder> make_bullet_pairs(std::span<const FloatAabb> boxes) { return std::make_unique<BulletPairs>(boxes); }

}  // namespace carom::bench
