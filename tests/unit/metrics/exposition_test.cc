#include "metrics/exposition.h"

#include <atomic>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::metrics {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Sample name with labels -> value.
std::map<std::string, double> Samples(const std::string& text) {
  std::map<std::string, double> samples;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#")) continue;
    const std::size_t space = line.rfind(' ');
    samples[line.substr(0, space)] = std::stod(line.substr(space + 1));
  }
  return samples;
}

double SettledAndInFlight(const std::map<std::string, double>& samples) {
  double sum = samples.at("uplinkd_uplinks_in_flight");
  for (const std::string outcome : {"stored", "applied", "superseded", "duplicate", "rejected"}) {
    sum += samples.at("uplinkd_uplinks_settled_total{outcome=\"" + outcome + "\"}");
  }
  return sum;
}

TEST(Exposition, WritesSamplesInTheCataloguesOrderWhateverTheCallsOrder) {
  Exposition page;
  page.Add(MetricId::kBuildInfo, 1, {"1.2\"3"});
  page.Add(MetricId::kStreams, 7);
  EXPECT_EQ(page.Text(),
            "# HELP uplinkd_streams Open streams.\n"
            "# TYPE uplinkd_streams gauge\n"
            "uplinkd_streams 7\n"
            "# HELP uplinkd_build_info Version of the server.\n"
            "# TYPE uplinkd_build_info gauge\n"
            "uplinkd_build_info{version=\"1.2\\\"3\"} 1\n");
}

TEST(Exposition, CumulatesBucketsAndEndsWithInfinity) {
  Distribution<8> records(kBatchBounds);
  records.Observe(1);     // at a bound: within it
  records.Observe(2);     // past it: the next
  records.Observe(5000);  // above all
  Exposition page;
  page.Add(MetricId::kStoreCommitRecords, records);
  const auto samples = Samples(page.Text());
  EXPECT_EQ(samples.at("uplinkd_store_commit_records_bucket{le=\"1\"}"), 1);
  EXPECT_EQ(samples.at("uplinkd_store_commit_records_bucket{le=\"4\"}"), 2);
  EXPECT_EQ(samples.at("uplinkd_store_commit_records_bucket{le=\"1000\"}"), 2);
  EXPECT_EQ(samples.at("uplinkd_store_commit_records_bucket{le=\"+Inf\"}"), 3);
  EXPECT_EQ(samples.at("uplinkd_store_commit_records_count"), 3);
  EXPECT_DOUBLE_EQ(samples.at("uplinkd_store_commit_records_sum"), 5003);
}

TEST(Exposition, ExportsEveryLabelOfClosedSetsAlsoAtZero) {
  Exposition page;
  page.AddLedger(LedgerBook().Sum());
  const auto samples = Samples(page.Text());
  for (const model::RejectReason reason : model::kAllRejectReasons) {
    const std::string label(model::ToText(reason));
    EXPECT_EQ(samples.count("uplinkd_rejects_total{reason=\"" + label + "\"}"), 1U) << label;
    EXPECT_EQ(samples.count("uplinkd_fields_dropped_total{variant=\"motionTelemetry\",reason=\"" +
                            label + "\"}"),
              1U);
  }
  for (std::size_t v = 0; v < model::kVariants; ++v) {
    const std::string label(model::ToText(static_cast<model::Variant>(v)));
    EXPECT_EQ(samples.count("uplinkd_records_total{kind=\"" + label + "\"}"), 1U) << label;
  }
  // Fields of durable kinds are never dropped: a durable message is rejected whole.
  EXPECT_THAT(page.Text(), Not(HasSubstr("uplinkd_fields_dropped_total{variant=\"fault\"")));
}

TEST(Exposition, ShowsTheAgesOfEachSourcesMessages) {
  LedgerBook book;
  MessageAges ages;
  AgeCounts& durable = ages[static_cast<std::size_t>(AgeKind::kDurable)];
  durable.Add(std::chrono::milliseconds(100));   // at a bound: within it
  durable.Add(std::chrono::milliseconds(101));   // past it: the next
  durable.Add(std::chrono::milliseconds(-500));  // of a clock that is ahead
  durable.Add(kAgeCountedMax);
  durable.Add(kAgeCountedMax + std::chrono::hours(24 * 365 * 50));  // of a clock of 1970
  book.NewPage(model::MessageSource::kCyberwave).Publish({}, ages);
  book.NewPage(model::MessageSource::kCyberwave).Publish({}, ages);
  Exposition page;
  page.AddAges(book);
  const auto samples = Samples(page.Text());
  const auto at = [&samples](const std::string& end, const std::string& labels) {
    return samples.at("uplinkd_message_age_seconds_" + end + "{" + labels + "}");
  };
  const std::string labels = R"(source="cyberwave",kind="durable")";
  EXPECT_EQ(at("bucket", labels + R"(,le="0.1")"), 4);
  EXPECT_EQ(at("bucket", labels + R"(,le="0.25")"), 6);
  EXPECT_EQ(at("bucket", labels + R"(,le="86400")"), 6);
  EXPECT_EQ(at("bucket", labels + R"(,le="+Inf")"), 10);
  EXPECT_DOUBLE_EQ(at("sum", labels), 2 * (0.1 + 0.101 + 2 * 30 * 86'400.0));
  EXPECT_EQ(at("count", R"(source="cyberwave",kind="live")"), 0);
  EXPECT_EQ(at("count", R"(source="uplink",kind="durable")"), 0);
  EXPECT_EQ(at("count", R"(source="uncrew",kind="live")"), 0);
}

TEST(Exposition, ShowsNumbersOf53BitsExactly) {
  LedgerBook book;
  MessageCounts counts;
  counts.received = (std::uint64_t{1} << 53U) - 1;
  counts.applied = counts.received;
  book.NewPage().Publish(counts);
  Exposition page;
  page.AddLedger(book.Sum());
  EXPECT_THAT(page.Text(), HasSubstr("uplinkd_uplinks_received_total 9007199254740991\n"));
}

TEST(Exposition, TheLawHoldsInEveryTextWhileThreadsCount) {
  LedgerBook book;
  std::atomic<bool> stop{false};
  std::vector<std::jthread> threads;
  threads.reserve(3);
  for (int t = 0; t < 3; ++t) {
    threads.emplace_back([&stop, &ledger = book.NewPage()] {
      while (!stop.load()) {
        MessageCounts arrived;
        arrived.received = 3;
        arrived.applied = 1;
        arrived.duplicate = 1;
        arrived.in_flight = 1;
        ledger.Publish(arrived);
        MessageCounts committed;
        committed.in_flight = -1;
        committed.stored = 1;
        ledger.Publish(committed);
        std::this_thread::yield();  // std::mutex is not fair; sessions do not count without pause
      }
    });
  }
  double last = 0;
  for (int scrape = 0; scrape < 30 || last == 0; ++scrape) {
    Exposition page;
    page.AddLedger(book.Sum());
    const auto samples = Samples(page.Text());
    last = samples.at("uplinkd_uplinks_received_total");
    ASSERT_EQ(last, SettledAndInFlight(samples));
  }
  stop = true;
}

TEST(Exposition, ALostSettlementShows) {
  LedgerBook book;
  MessageCounts lost;
  lost.received = 1;
  book.NewPage().Publish(lost);
  Exposition page;
  page.AddLedger(book.Sum());
  const auto samples = Samples(page.Text());
  EXPECT_NE(samples.at("uplinkd_uplinks_received_total"), SettledAndInFlight(samples));
}

TEST(ExpositionDeathTest, ASampleWithoutItsLabelsIsOurBug) {
  Exposition page;
  EXPECT_DEATH(page.Add(MetricId::kRejects, 1), "labels of its entry");
}

}  // namespace
}  // namespace uplink::metrics
