// What one message brings is committed at once, or not at all.
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/journal_bench.h"

namespace uplink::journal {
namespace {

using ::testing::ElementsAre;
using testing::FailAt;

JournalLimits Small(std::size_t batch_records_max, std::size_t robot_records_max) {
  JournalLimits limits;
  limits.batch_records_max = batch_records_max;
  limits.batch_robot.records_max = robot_records_max;
  return limits;
}

class Messages : public ::testing::Test {
 protected:
  static void AppendMessage(JournalBench& bench, RecordingClient& client, model::Seq first,
                            std::size_t count) {
    std::vector<storage::CommitRecord> records;
    for (std::size_t i = 0; i < count; ++i) {
      records.push_back({.robot = client.robot(),
                         .session = JournalBench::kSession,
                         .seq = first + i,
                         .received_at = bench.clock.System(),
                         .content = FaultRecord(),
                         .payload = "",
                         .payload_bytes = 0});
    }
    bench.journal.AppendMessage(client, client.generation(), std::move(records),
                                bench.clock.Steady());
  }
  static void Open(JournalBench& bench, RecordingClient& client) {
    bench.Open(client);
    bench.Run();
    static_cast<void>(client.Told());
  }
};

TEST_F(Messages, StayTogetherPastTheEndOfABatch) {
  JournalBench bench(Small(4, 100));
  RecordingClient client("rcan://a");
  Open(bench, client);
  bench.Append(client, 1);
  AppendMessage(bench, client, 2, 2);
  AppendMessage(bench, client, 4, 3);
  bench.Append(client, 7);
  bench.Run();
  EXPECT_THAT(client.Told(), ElementsAre("settled 1 2 3 4 5 6", "settled 7"));
  EXPECT_TRUE(bench.journal.idle());
}

TEST_F(Messages, StayTogetherInTheLineOfARobotThatLags) {
  JournalBench bench(Small(4, 2));
  RecordingClient client("rcan://a");
  RecordingClient other("rcan://b");
  Open(bench, client);
  Open(bench, other);
  AppendMessage(bench, client, 1, 3);
  AppendMessage(bench, client, 4, 3);
  AppendMessage(bench, client, 7, 2);
  AppendMessage(bench, other, 1, 2);
  bench.Run();
  EXPECT_THAT(client.Told(), ElementsAre("settled 1 2 3", "settled 4 5 6", "settled 7 8"));
  EXPECT_THAT(other.Told(), ElementsAre("settled 1 2")) << "it passed the one that lags";
}

TEST_F(Messages, StayTogetherWhereABatchIsHalved) {
  JournalBench bench;
  RecordingClient client("rcan://a");
  Open(bench, client);
  AppendMessage(bench, client, 1, 2);
  AppendMessage(bench, client, 3, 3);
  AppendMessage(bench, client, 6, 3);
  bench.store.FailNextCommits(kFailuresToHalve, FailAt::kBefore);
  bench.Run();
  for (int i = 0; i < kFailuresToHalve; ++i) (void)bench.journal.turns().Advance();
  bench.Run();
  EXPECT_THAT(client.Told(), ElementsAre("settled 1 2 3 4 5", "settled 6 7 8"))
      << "a cut after the fourth would have parted the second message";
  EXPECT_TRUE(bench.journal.idle());
}

TEST_F(Messages, AreVoidAsAWhole) {
  JournalBench bench;
  RecordingClient client("rcan://a");
  Open(bench, client);
  AppendMessage(bench, client, 1, 3);
  metrics::Ledger ledger;
  static_cast<void>(client.OnFenced(ledger));
  static_cast<void>(client.Told());
  bench.Run();
  EXPECT_THAT(client.Told(), ElementsAre());
  EXPECT_TRUE(bench.Stored(client).empty());
  EXPECT_TRUE(bench.journal.idle());
}

}  // namespace
}  // namespace uplink::journal
