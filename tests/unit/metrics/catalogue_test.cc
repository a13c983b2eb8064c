#include "metrics/catalogue.h"

#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::metrics {
namespace {

TEST(Catalogue, NamesAreUniqueAndSayTheirUnit) {
  std::set<std::string_view> names;
  for (const MetricSpec& spec : Catalogue()) {
    EXPECT_TRUE(names.insert(spec.name).second) << spec.name;
    EXPECT_EQ(spec.name.ends_with("_total"), spec.type == MetricType::kCounter) << spec.name;
    if (spec.unit == "seconds" || spec.unit == "bytes") {
      EXPECT_THAT(std::string(spec.name), ::testing::HasSubstr(std::string(spec.unit)));
    }
    EXPECT_FALSE(spec.help.empty()) << spec.name;
    EXPECT_TRUE(spec.help.ends_with(".")) << spec.name;
    EXPECT_EQ(&SpecOf(spec.id), &spec);
  }
  EXPECT_EQ(names.size(), kMetrics);
}

/// What a family takes of the names of a scrape in OpenMetrics' form: its own, and those of its
/// samples. A reader of that form takes no name twice (OpenMetrics 1.0.0, Overall Structure).
std::vector<std::string> NamesInOpenMetrics(const MetricSpec& spec) {
  std::string family(spec.name);
  switch (spec.type) {
    case MetricType::kGauge:
      return {family};
    case MetricType::kCounter:
      family.resize(family.size() - std::string_view("_total").size());
      return {family, family + "_total", family + "_created"};
    case MetricType::kHistogram:
      return {family, family + "_bucket", family + "_count", family + "_sum", family + "_created"};
  }
  return {};
}

TEST(Catalogue, NoNameIsTakenTwiceInOpenMetrics) {
  std::map<std::string, std::string_view> taken;
  for (const MetricSpec& spec : Catalogue()) {
    for (const std::string& name : NamesInOpenMetrics(spec)) {
      const auto [place, is_new] = taken.emplace(name, spec.name);
      EXPECT_TRUE(is_new) << name << " is taken by " << place->second << " and by " << spec.name;
    }
  }
}

TEST(Catalogue, HoldsTheNamesThatTheSurfaceFixes) {
  std::set<std::string_view> names;
  for (const MetricSpec& spec : Catalogue()) names.insert(spec.name);
  for (const std::string_view name :
       {"uplinkd_uplinks_received_total", "uplinkd_uplinks_settled_total",
        "uplinkd_uplinks_in_flight", "uplinkd_rejects_total", "uplinkd_fields_dropped_total",
        "uplinkd_uplinks_missing_total", "uplinkd_records_total", "uplinkd_robots",
        "uplinkd_streams", "uplinkd_store_commit_seconds", "uplinkd_store_commit_records",
        "uplinkd_ack_seconds", "uplinkd_journal_records", "uplinkd_journal_bytes",
        "uplinkd_journal_oldest_seconds"}) {
    EXPECT_EQ(names.count(name), 1U) << name;
  }
}

TEST(Catalogue, TheReferencePageHoldsTheTable) {
  std::ifstream file("docs/reference/metrics.md");
  ASSERT_TRUE(file) << "docs/reference/metrics.md cannot be read";
  std::stringstream page;
  page << file.rdbuf();
  EXPECT_NE(page.str().find(CatalogueTable()), std::string::npos)
      << "replace the table by the output of: uplinkd --print-metrics";
}

}  // namespace
}  // namespace uplink::metrics
