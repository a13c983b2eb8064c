#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/server_world.h"

namespace uplink::http {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kGoldenFile = "tests/unit/server/http/metrics.golden";

/// The TYPE lines: names and types without values.
std::string Types(const std::string& text) {
  std::string types;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("# TYPE ")) types += line.substr(7) + "\n";
  }
  return types;
}

TEST(Scrape, HoldsTheGoldenListOfMetrics) {
  const testing::ServerWorld world;
  std::ifstream file(kGoldenFile);
  std::stringstream golden;
  golden << file.rdbuf();
  EXPECT_EQ(Types(world.ScrapeText()), golden.str())
      << "names are what dashboards depend on; if the change is meant, change " << kGoldenFile;
}

TEST(Scrape, HoldsEveryMetricOfTheCatalogue) {
  const testing::ServerWorld world;
  const std::string text = world.ScrapeText();
  for (const metrics::MetricSpec& spec : metrics::Catalogue()) {
    EXPECT_NE(text.find("# TYPE " + std::string(spec.name) + " "), std::string::npos) << spec.name;
  }
}

void ExpectLines(const std::string& text, const std::vector<std::string>& lines) {
  for (const std::string& line : lines) EXPECT_THAT(text, HasSubstr("\n" + line + "\n"));
}

TEST(Scrape, ShowsLimitsBesideWhatTheyLimit) {
  const testing::ServerWorld world;
  ExpectLines(world.ScrapeText(),
              {"uplinkd_robots_limit 5", "uplinkd_journal_bytes_limit 268435456",
               "uplinkd_http_connections_limit{listener=\"http\"} 4",
               "uplinkd_http_connections_limit{listener=\"metrics\"} 2",
               "uplinkd_http_reads_waiting_limit 64"});
}

TEST(Scrape, EveryWordOfDegradedHasItsSeries) {
  testing::ServerWorld world;
  std::string text = world.ScrapeText();
  for (const health::DegradedWord& each : health::DegradedWords()) {
    const std::string line = "uplinkd_degraded{reason=\"" + std::string(each.word) + "\"} 0\n";
    EXPECT_NE(text.find(line), std::string::npos) << each.word;
  }
  world.journal_probe.store_failing.Set(1);
  text = world.ScrapeText();
  EXPECT_NE(text.find("uplinkd_degraded{reason=\"store\"} 1\n"), std::string::npos);
  EXPECT_NE(text.find("uplinkd_degraded{reason=\"lease\"} 0\n"), std::string::npos);
}

TEST(Scrape, StreamsThatAreHeldBackAddUpByReason) {
  testing::ServerWorld world;
  const auto held_back_by = [&](const std::string& reason, int streams) {
    const std::string line = "uplinkd_streams_held_back{reason=\"" + reason + "\"} ";
    return world.ScrapeText().find(line + std::to_string(streams) + "\n") != std::string::npos;
  };
  world.sessions.held_back_by[static_cast<std::size_t>(robot::HeldBack::kFlow)].Add(2);
  world.sessions.held_back.Add(3);
  EXPECT_TRUE(held_back_by("flow", 2));
  EXPECT_TRUE(held_back_by("journal", 0));
  EXPECT_TRUE(held_back_by("ending", 1)) << "of it no reason is told";
  world.sessions.held_back.Add(-2);
  EXPECT_TRUE(held_back_by("ending", 0)) << "the cells were read while a stream went on";
}

TEST(Scrape, EachShardOfTheJournalHasItsFigures) {
  const testing::ServerWorld world;
  ExpectLines(world.ScrapeText(), {"uplinkd_journal_shard_records{shard=\"0\"} 0",
                                   "uplinkd_journal_shard_bytes{shard=\"0\"} 0",
                                   "uplinkd_journal_shard_oldest_seconds{shard=\"0\"} 0",
                                   "uplinkd_journal_shard_bytes_limit 268435456"});
}

TEST(Scrape, SaysWhatTheStoresDiskHasLeftAndWhatIsDoneAboutIt) {
  testing::ServerWorld world;
  world.space_view = {
      .space = storage::DiskSpace{.free_bytes = 49, .total_bytes = 1000, .wal_bytes = 12},
      .free_min = 100,
      .state = store::SpaceState::kStopped,
      .robots_limited = 3};
  ExpectLines(world.ScrapeText(),
              {"uplinkd_store_free_bytes 49", "uplinkd_store_free_min_bytes 100",
               "uplinkd_store_disk_bytes 1000", "uplinkd_store_wal_bytes 12",
               "uplinkd_store_stopped 1", "uplinkd_store_robots_limited 3"});
  // A store that has no WAL beside its file.
  world.space_view.space->wal_bytes = std::nullopt;
  EXPECT_THAT(world.ScrapeText(), Not(HasSubstr("uplinkd_store_wal_bytes")));
  // What is not known has no series: an alert that compares it is silent.
  world.space_view = {};
  const std::string text = world.ScrapeText();
  EXPECT_THAT(text, Not(HasSubstr("uplinkd_store_free_bytes")));
  EXPECT_THAT(text, Not(HasSubstr("uplinkd_store_disk_bytes")));
  ExpectLines(text, {"uplinkd_store_stopped 0"});
}

TEST(Scrape, CountsWhatTheJournalStoredAndSwept) {
  testing::ServerWorld world;
  world.journal_probe.presence_changes[static_cast<std::size_t>(model::Presence::kOffline)].Add(3);
  world.journal_probe.expired_deleted.Add(4);
  ExpectLines(world.ScrapeText(), {"uplinkd_presence_changes_total{presence=\"online\"} 0",
                                   "uplinkd_presence_changes_total{presence=\"offline\"} 3",
                                   "uplinkd_presence_changes_total{presence=\"unknown\"} 0",
                                   "uplinkd_expired_deleted_total 4"});
}

TEST(Scrape, NeverNamesARobot) {
  testing::ServerWorld world;
  world.AddRobot("rcan://secret");
  world.fleet.Sweep(std::chrono::hours(1));
  const std::string text = world.ScrapeText();
  EXPECT_NE(text.find("uplinkd_robots{fleet=\"default\",presence=\"unknown\"} 1\n"),
            std::string::npos);
  EXPECT_EQ(text.find("rcan://"), std::string::npos);
}

}  // namespace
}  // namespace uplink::http
