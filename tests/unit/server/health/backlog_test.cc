#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/health/monitor.h"
#include "tests/unit/server/journal/journal_bench.h"

namespace uplink::health {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::size_t kShards = 16;

class BacklogTest : public ::testing::Test {
 protected:
  BacklogTest() {
    std::vector<journal::Journal*> journals;
    for (std::size_t i = 0; i < kShards; ++i) {
      benches_.push_back(std::make_unique<journal::JournalBench>());
      journals.push_back(&benches_.back()->journal);
    }
    limits_.records_max = 10 * kShards;
    shards_ = std::make_unique<journal::Shards>(journals);
    monitor_ = std::make_unique<Monitor>(
        Monitor::Sources{.clock = clock_,
                         .fleet = fleet_,
                         .journals = *shards_,
                         .journal_probe = probe_,
                         .sessions = sessions_,
                         .journal_limits = limits_,
                         .certificate_expiry = clock_.System() + std::chrono::hours(24 * 365)});
  }

  testing::ManualClock clock_;
  fleet::Fleet fleet_{clock_, 10, {}};
  journal::JournalProbe probe_;
  session::SessionProbe sessions_;
  journal::JournalLimits limits_;
  std::vector<std::unique_ptr<journal::JournalBench>> benches_;
  std::unique_ptr<journal::Shards> shards_;
  std::unique_ptr<Monitor> monitor_;
};

TEST_F(BacklogTest, OneStuckShardOfSixteenIsABacklog) {
  journal::RecordingClient client("rcan://a");
  model::Seq seq = 0;
  while (seq < 8) benches_[11]->Append(client, ++seq);
  EXPECT_THAT(monitor_->readiness().degraded, IsEmpty()) << "four fifths of its share";
  benches_[11]->Append(client, ++seq);
  EXPECT_THAT(monitor_->readiness().degraded, ElementsAre("journal_backlog"));
}

}  // namespace
}  // namespace uplink::health
