// Ids and the slot map, against a reference model.
#include <carom/core/ids.hpp>
#include <carom/core/random.hpp>
#include <carom/core/slot_map.hpp>

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

namespace carom {
namespace {

TEST(Id, DefaultIsNullAndTypesDoNotMix) {
    EXPECT_FALSE(BodyId{});
    EXPECT_TRUE((BodyId{0, 1}));
    EXPECT_FALSE((std::is_convertible_v<BodyId, ShapeId>));
    EXPECT_LT((BodyId{1, 9}), (BodyId{2, 1}));
    EXPECT_NE((BodyId{1, 1}), (BodyId{1, 2}));
}

TEST(SlotMap, BehavesAsAMapWhoseKeysAreNeverReused) {
    SlotMap<std::string, BodyId> slots;
    std::map<BodyId, std::string> model;
    std::vector<BodyId> ever;  // dead ones too
    Random random(0x510);
    for (int i = 0; i < 20000; ++i) {
        const double what = random.unit();
        if (what < 0.45 || ever.empty()) {
            const std::string value = std::to_string(i);
            const BodyId id = slots.insert(value);
            ASSERT_TRUE(id);
            ASSERT_FALSE(model.contains(id));
            model[id] = value;
            ever.push_back(id);
        } else {
            const BodyId id = ever[static_cast<std::size_t>(random.unit() * static_cast<double>(ever.size()))];
            if (what < 0.85) {
                ASSERT_EQ(slots.erase(id), model.erase(id) == 1);
            }
            const auto found = model.find(id);
            const std::string* value = slots.find(id);
            ASSERT_EQ(value != nullptr, found != model.end());
            if (value != nullptr) {
                ASSERT_EQ(*value, found->second);
            }
        }
        ASSERT_EQ(slots.size(), model.size());
    }
    for (const BodyId& id : ever) ASSERT_EQ(slots.find(id) != nullptr, model.contains(id));
}

TEST(SlotMap, SameCallsGiveSameIdsLastErasedFirst) {
    SlotMap<int, BodyId> slots;
    const BodyId a = slots.insert(1), b = slots.insert(2);
    slots.insert(3);
    EXPECT_TRUE(slots.erase(a));
    EXPECT_TRUE(slots.erase(b));
    EXPECT_EQ(slots.insert(4), (BodyId{b.slot, b.generation + 1}));
    EXPECT_EQ(slots.insert(5), (BodyId{a.slot, a.generation + 1}));
}

TEST(SlotMap, RefusesIdsItNeverGave) {
    SlotMap<int, BodyId> slots;
    const BodyId id = slots.insert(7);
    for (const BodyId bad : {BodyId{}, BodyId{0, 2}, BodyId{0, 0}, BodyId{1, 1}, BodyId{~0u, ~0u}}) {
        EXPECT_EQ(slots.find(bad), nullptr);
        EXPECT_FALSE(slots.erase(bad));
    }
    EXPECT_EQ(*slots.find(id), 7);
    EXPECT_EQ(*std::as_const(slots).find(id), 7);
}

TEST(SlotMap, HoldsAndFreesTypesThatOnlyMove) {
    SlotMap<std::unique_ptr<int>, BodyId> slots;
    const BodyId id = slots.insert(std::make_unique<int>(5));
    EXPECT_EQ(**slots.find(id), 5);
    EXPECT_TRUE(slots.erase(id));
    const BodyId next = slots.insert(std::make_unique<int>(6));
    EXPECT_EQ(**slots.find(next), 6);
    EXPECT_EQ(slots.find(id), nullptr);
}

}  // namespace
}  // namespace carom
