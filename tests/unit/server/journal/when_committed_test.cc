// Who waits for a commit alone, whatever it holds.
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/journal/journal_bench.h"

namespace uplink::journal {
namespace {

using ::testing::ElementsAre;
using testing::FailAt;
using ::testing::IsEmpty;

class WhenCommittedTest : public ::testing::Test, protected JournalBench {
 protected:
  /// Writes down what is told, in its order.
  class Lines final : public loop::WakeInbox {
   public:
    explicit Lines(std::vector<std::string>& lines) : lines_(lines) {}
    void Wake(std::uint64_t stream) override {
      lines_.push_back("committed " + std::to_string(stream));
    }

   private:
    std::vector<std::string>& lines_;
  };

  WhenCommittedTest() {
    journal.OnReconnected([this](Reconnected) { told_.emplace_back("reconnected"); });
  }
  using JournalBench::Run;
  void Ask(std::uint64_t stream) { journal.WhenCommitted({.inbox = &inbox_, .stream = stream}); }
  std::vector<std::string> Told() { return std::exchange(told_, {}); }

  std::vector<std::string> told_;
  Lines inbox_{told_};
};

TEST_F(WhenCommittedTest, ASecondListenerAbortsRatherThanReplacesTheFirst) {
  journal.OnSpatial([] {});
  EXPECT_DEATH(journal.OnSpatial([] {}), "one listener hears of shapes");
  EXPECT_DEATH(journal.OnReconnected([](Reconnected) {}), "one listener hears that the store");
  journal.OnSlowCommit([](const SlowCommit&) {});
  EXPECT_DEATH(journal.OnSlowCommit([](const SlowCommit&) {}), "one listener hears of slow");
}

TEST_F(WhenCommittedTest, AnEmptyBatchIsCommittedIfNothingElseWaits) {
  Run();
  const std::uint64_t before = store.commits();
  Ask(1);
  EXPECT_THAT(Told(), IsEmpty());
  Run();
  EXPECT_THAT(Told(), ElementsAre("committed 1"));
  EXPECT_EQ(store.commits() - before, 1U);
  Run();
  EXPECT_THAT(Told(), IsEmpty()) << "once";
  EXPECT_EQ(store.commits() - before, 1U);
}

TEST_F(WhenCommittedTest, OneCommitAnswersAllAndWritesWhatWaits) {
  RecordingClient client("rcan://a");
  Open(client);
  Run();
  const std::uint64_t before = store.commits();
  Append(client, 1);
  Ask(1);
  Ask(2);
  Ask(1);
  Run();
  EXPECT_THAT(Told(), ElementsAre("committed 1", "committed 2"));
  EXPECT_THAT(Stored(client), ElementsAre(1U));
  EXPECT_EQ(store.commits() - before, 1U);
}

TEST_F(WhenCommittedTest, ACommitThatFailedOrWhoseAnswerIsLostTellsNothing) {
  Ask(1);
  store.FailNextCommits(1, FailAt::kBefore);
  store.FailNextCommits(1, FailAt::kAfter);
  Run();
  Run();
  EXPECT_THAT(Told(), IsEmpty());
  Run();
  EXPECT_THAT(Told(), ElementsAre("committed 1"));
}

TEST_F(WhenCommittedTest, ACommitThatBeganBeforeDoesNotCount) {
  RecordingClient client("rcan://a");
  Open(client);
  Run();
  Append(client, 1);
  ASSERT_EQ(journal.turns().Advance(), Step::kWorked);
  Ask(1);
  ASSERT_EQ(journal.turns().Advance(), Step::kWorked);
  EXPECT_THAT(client.Told(), ::testing::Contains("settled 1"));
  EXPECT_THAT(Told(), IsEmpty());
  Run();
  EXPECT_THAT(Told(), ElementsAre("committed 1"));
}

TEST_F(WhenCommittedTest, ThatTheStoreWasConnectedToAnewIsToldBefore) {
  Ask(1);
  store.FailNextCommits(1, FailAt::kBefore);
  Run();
  store.Break();
  Run();
  EXPECT_THAT(Told(), ElementsAre("reconnected", "committed 1"));
}

}  // namespace
}  // namespace uplink::journal
