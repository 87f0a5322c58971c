// The studies of continuous collision: their cases are what they say, and nothing is missed.
#include <carom/studies/accuracy/catalogue.hpp>

#include <gtest/gtest.h>

#include <cstdlib>

namespace carom::accuracy {
namespace {

TEST(ImpactStudies, NothingIsMissedAndLittleIsMadeUp) {
    for (const auto& make : {ccd_studies, toi_studies, sweep_studies}) {
        for (const Study& study : make({.quick = true})) {
            ASSERT_FALSE(study.candidates.empty());
            for (std::size_t i = 0; i < study.candidates.size(); ++i) {
                const Sample sample = study.candidates[i].run();
                EXPECT_EQ(sample.failures, 0u) << study.name << " " << to_string(study.candidates[i].settings);
                ASSERT_TRUE(sample.error.has_value());
                EXPECT_GE(*sample.error, 0.0);
                EXPECT_GT(sample.time_s, 0.0);
            }
            // Without a tolerance and with room to search, only rounding is left.
            const double rounding = study.name == "sweeps" ? 1e-12 : study.name.starts_with("ccd") ? 0.01 : 1.0;
            EXPECT_LT(*study.candidates[0].run().error, rounding) << study.name;
        }
    }
}

TEST(ImpactStudies, ToleranceAndCapMakeContactsUpAndHardlyCostEarliness) {
    const std::vector<Study> studies = ccd_studies({.quick = true});
    ASSERT_EQ(studies[0].name, "ccd");
    ASSERT_EQ(studies[1].name, "ccd_early");
    const auto error = [&](std::size_t study, std::size_t candidate) { return *studies[study].candidates[candidate].run().error; };
    // Real contacts are hardly earlier. Published queries have some that begin within the tolerance, or that slide: those are earlier by much.
    const double hardly = std::getenv("CAROM_CCD_QUERIES") == nullptr ? 1e-11 : 0.01;
    for (std::size_t k = 0; k < 8; ++k) EXPECT_LT(error(1, k), hardly) << k;
    EXPECT_GT(error(1, 4), error(1, 0));
    EXPECT_EQ(error(0, 0), 0.0);
    EXPECT_GT(error(0, 2), 0.0);          // contacts are made up, more of them with a coarser tolerance
    EXPECT_GT(error(0, 4), error(0, 2));
    EXPECT_GT(error(0, 7), error(0, 5));  // and with a small cap
}

}  // namespace
}  // namespace carom::accuracy
