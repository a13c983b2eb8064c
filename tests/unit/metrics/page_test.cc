#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "metrics/exposition.h"

namespace uplink::metrics {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

TEST(PageText, HoldsTheSamplesOfEachSourceInTheOrderOfTheCatalogue) {
  const std::vector<PageSource> sources = {
      [](Exposition& page) { page.Add(MetricId::kDraining, 1); },
      [](Exposition& page) { page.Add(MetricId::kRobotsLimit, 5); },
  };
  const std::string text = PageText(sources, Format::kText);
  const std::size_t limit = text.find("uplinkd_robots_limit 5\n");
  ASSERT_NE(limit, std::string::npos);
  EXPECT_LT(limit, text.find("uplinkd_draining 1\n"));
}

TEST(PageText, AsksEachSourceOnce) {
  int asked = 0;
  const std::vector<PageSource> sources = {[&](Exposition& /*page*/) { ++asked; }};
  EXPECT_THAT(PageText(sources, Format::kText), "");
  EXPECT_EQ(asked, 1);
}

TEST(PageText, IsWrittenInTheFormatThatIsAskedFor) {
  const std::vector<PageSource> sources = {
      [](Exposition& page) { page.Add(MetricId::kRobotsLimit, 5); }};
  EXPECT_THAT(PageText(sources, Format::kOpenMetrics), EndsWith("# EOF\n"));
  EXPECT_THAT(PageText(sources, Format::kOpenMetrics), HasSubstr("uplinkd_robots_limit 5\n"));
}

}  // namespace
}  // namespace uplink::metrics
