// Processes on one database that tell each other of commits, by LISTEN and NOTIFY.
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "schema/base/clock.h"
#include "storage/postgres/link/connection.h"
#include "storage/postgres/parts.h"
#include "storage/postgres/store.h"
#include "tests/support/eventually.h"
#include "tests/support/fake_trust.h"
#include "tests/support/manual_clock.h"
#include "tests/support/postgres_database.h"
#include "tests/support/records.h"
#include "tests/unit/schema/samples.h"

namespace uplink::storage::postgres {
namespace {

using testing::Eventually;
using testing::kPatience;
using testing::PostgresDatabase;

constexpr milliseconds kNow{0};

class PostgresSignalTest : public ::testing::Test {
 protected:
  using Signal = std::unique_ptr<ChangeSignal>;

  StoreOptions Options() const {
    StoreOptions options;
    options.url = database_.url();
    return options;
  }
  Signal Make(const Clock& clock, Channel channel = Channel::kItems) {
    return *MakeChangeSignal(Options(), clock, channel);
  }
  /// One that listens by now.
  Signal Listening(Channel channel = Channel::kItems) {
    Signal signal = Make(clock_, channel);
    EXPECT_FALSE(Hears(*signal));
    return signal;
  }
  static bool Hears(ChangeSignal& signal, milliseconds most = kNow) {
    const auto heard = signal.Wait(most);
    EXPECT_TRUE(heard.ok()) << heard.status();
    return heard.ok() && *heard;
  }
  static void TellNow(ChangeSignal& signal) {
    signal.Tell();
    EXPECT_FALSE(Hears(signal));
  }
  /// What was sent to the database's sessions before this call has been heard after it: a session
  /// that notifies reads all that came before.
  static bool HasHeard(ChangeSignal& signal) {
    signal.Tell();
    return Hears(signal);
  }
  void EndSessions() {
    const std::string from =
        " FROM pg_stat_activity WHERE datname = current_database() AND usename = 'uplinkd'";
    shell_.Run("SELECT pg_terminate_backend(pid)" + from);
    EXPECT_TRUE(Eventually([&] { return shell_.Read("SELECT count(*)" + from) == "0\n"; }));
  }

  const SystemClock clock_{};
  PostgresDatabase database_;
  testing::PostgresShell shell_ = database_.Shell();
};

/// Counts notifications, each by itself.
class Counter {
 public:
  Counter(const std::string& url, const Clock& clock) {
    ConnectionOptions options;
    options.url = *ParseUrl(url);
    connection_ = *Connection::Open(options, clock);
    Ask("LISTEN uplinkd_changes");
  }
  /// Since the last call.
  std::size_t Count() {
    Ask("SELECT 1");
    const auto count = connection_->TakeNotifications(0);
    EXPECT_TRUE(count.ok()) << count.status();
    return count.ok() ? *count : 0;
  }

 private:
  void Ask(std::string_view sql) {
    std::vector<StoreCall> calls;
    calls.push_back({sql, {}});
    EXPECT_TRUE(connection_->Run(calls, "ask").ok());
  }
  std::unique_ptr<Connection> connection_;
};

TEST_F(PostgresSignalTest, WhatOneTellsTheOthersHearOnceAndItselfDoesNot) {
  const Signal one = Listening();
  const Signal other = Listening();
  const Signal third = Listening();
  TellNow(*one);
  EXPECT_TRUE(Hears(*other, kPatience));
  EXPECT_TRUE(Hears(*third, kPatience));
  EXPECT_FALSE(HasHeard(*other));
  EXPECT_TRUE(Hears(*one, kPatience)) << "the other's, and not its own";
}

TEST_F(PostgresSignalTest, WhoFollowsAccessIsWokenByItsWritesAlone) {
  PostgresStore::Open(Options(), clock_).IgnoreError();  // makes the schema
  const Signal access = Listening(Channel::kAccess);
  const Signal items = Listening();
  const auto store = *MakeAccessStore(Options(), clock_);
  AuditRow audit;
  audit.who = "a";
  Revocation revocation;
  revocation.value = "aa";
  ASSERT_TRUE(*store->Revoke(revocation, audit));
  EXPECT_TRUE(Hears(*access, kPatience));
  SettingChange change;
  change.ruri = "rcan://robots/a";
  change.blocked = true;
  ASSERT_TRUE(store->Change(change, audit).ok());
  EXPECT_TRUE(Hears(*access, kPatience));
  ASSERT_TRUE(store->Append(audit).ok());
  EXPECT_FALSE(HasHeard(*access)) << "it changes no version";
  TellNow(*items);
  EXPECT_FALSE(HasHeard(*access));
  EXPECT_FALSE(HasHeard(*items)) << "nor those of access the items";
}

TEST_F(PostgresSignalTest, AWaitIsEndedByWhatAnotherTells) {
  const Signal one = Listening();
  const Signal other = Listening();
  std::jthread waits([&] { EXPECT_TRUE(Hears(*other, 2 * kPatience)); });
  std::jthread tells([&] { EXPECT_FALSE(Hears(*one, 2 * kPatience)); });
  // Out of its wait.
  one->Tell();
  waits.join();
  one->End();
}

TEST_F(PostgresSignalTest, ManyTellingsWithinAWhileAreOneAtItsBeginningAndOneAtItsEnd) {
  testing::ManualClock clock;
  const Signal one = Make(clock);
  EXPECT_FALSE(Hears(*one));
  Counter counter(database_.url(), clock_);
  const auto tell_often = [&] {
    for (int i = 0; i < 100; ++i) TellNow(*one);
  };
  tell_often();
  EXPECT_EQ(counter.Count(), 1U);
  clock.Advance(kTellEvery - milliseconds(1));
  tell_often();
  EXPECT_EQ(counter.Count(), 0U);
  clock.Advance(milliseconds(1));
  EXPECT_FALSE(Hears(*one));
  EXPECT_EQ(counter.Count(), 1U) << "nothing is left untold";
  clock.Advance(kTellEvery);
  EXPECT_FALSE(Hears(*one));
  EXPECT_EQ(counter.Count(), 0U);
}

TEST_F(PostgresSignalTest, WhatWaitsForItsTimeIsToldByTheWaitUnderWay) {
  const Signal one = Listening();
  Counter counter(database_.url(), clock_);
  TellNow(*one);
  one->Tell();
  std::jthread tells([&] { EXPECT_FALSE(Hears(*one, 2 * kPatience)); });
  std::size_t count = 0;
  EXPECT_TRUE(Eventually([&] { return (count += counter.Count()) >= 2; }));
  one->End();
}

TEST_F(PostgresSignalTest, AfterItsSessionEndedItHearsAndTellsAgain) {
  const Signal one = Listening();
  const Signal other = Listening();
  EndSessions();
  for (const Signal* signal : {&one, &other}) {
    absl::Status ended;
    EXPECT_TRUE(Eventually([&] { return !(ended = (*signal)->Wait(kNow).status()).ok(); }));
    EXPECT_TRUE(absl::IsUnavailable(ended)) << ended;
    EXPECT_FALSE(Hears(**signal));
  }
  TellNow(*one);
  EXPECT_TRUE(Hears(*other, kPatience));
  TellNow(*other);
  EXPECT_TRUE(Hears(*one, kPatience));
}

TEST_F(PostgresSignalTest, AWaitUnderWayEndsWithItsSession) {
  const Signal one = Listening();
  std::jthread waits([&] {
    const absl::Status ended = one->Wait(2 * kPatience).status();
    EXPECT_TRUE(absl::IsUnavailable(ended)) << ended;
  });
  EndSessions();
}

TEST_F(PostgresSignalTest, WhatCouldNotBeToldIsToldLater) {
  const Signal one = Listening();
  EndSessions();
  const Signal other = Listening();
  one->Tell();
  EXPECT_FALSE(one->Wait(kNow).ok());
  const SteadyTime end = clock_.Steady() + kPatience;
  std::jthread tells([&] { EXPECT_FALSE(Hears(*one, 2 * kPatience)); });
  EXPECT_TRUE(Hears(*other, kPatience));
  EXPECT_LT(clock_.Steady(), end);
  one->End();
}

TEST_F(PostgresSignalTest, AnEndIsPromptAndForGood) {
  const Signal one = Listening();
  const SteadyTime began = clock_.Steady();
  std::jthread waits([&] { EXPECT_FALSE(Hears(*one, 10 * kPatience)); });
  one->End();
  waits.join();
  EXPECT_FALSE(Hears(*one, 10 * kPatience));
  EXPECT_LT(clock_.Steady() - began, kPatience);
}

TEST_F(PostgresSignalTest, AServerThatIsAwayIsAnErrorOfEachWait) {
  StoreOptions options;
  options.url = "postgresql://uplinkd@127.0.0.1:1/x";
  const auto signal = MakeChangeSignal(options, clock_);
  ASSERT_TRUE(signal.ok()) << signal.status();
  (*signal)->Tell();
  for (int i = 0; i < 2; ++i) {
    const auto heard = (*signal)->Wait(kPatience);
    EXPECT_TRUE(absl::IsUnavailable(heard.status())) << heard.status();
  }
  (*signal)->End();
  EXPECT_FALSE(Hears(**signal)) << "and after its end not even tried";
}

TEST_F(PostgresSignalTest, AnotherDatabaseIsNotHeard) {
  PostgresDatabase elsewhere;
  StoreOptions options;
  options.url = elsewhere.url();
  const auto there = *MakeChangeSignal(options, clock_);
  const Signal here = Listening();
  TellNow(*there);
  EXPECT_FALSE(HasHeard(*here));
}

// PostgreSQL lets transactions that notify commit one after the other.
TEST_F(PostgresSignalTest, TheTransactionOfABatchNotifiesNobody) {
  testing::FakeTrust trust;
  StoreOptions options;
  options.url = database_.url();
  options.process = {1};
  options.rules.clock = &trust;
  const auto store = *PostgresStore::Open(options, clock_);
  const RobotRef robot =
      std::make_shared<const model::RobotId>(model::RobotId{"rcan://robots/a", "f1"});
  const model::SessionId session{{7}};
  const SystemTime now = FromUnixMs(1'763'683'200'000);
  const OpenRequest request{robot, session, 0, now, {}};
  const auto opened = store->OpenStreams({&request, 1});
  ASSERT_TRUE(opened.ok()) << opened.status();
  const Signal signal = Listening();
  Counter counter(database_.url(), clock_);
  model::ReportedShape shape = test::SampleShape();
  shape.scope = model::ScopeType::kFleet;
  Batch batch;
  batch.records.push_back({robot, session, 1, opened->front().held_since, now,
                           test::RecordOf(model::ShapeOp{shape}), "bytes", 5});
  const auto outcomes = store->Commit(batch);
  ASSERT_TRUE(outcomes.ok()) << outcomes.status();
  ASSERT_EQ(outcomes->front().kind, OutcomeKind::kStored);
  EXPECT_EQ(shell_.Read("SELECT count(*) FROM uplinkd.changes"), "1\n");
  EXPECT_EQ(counter.Count(), 0U);
  EXPECT_FALSE(HasHeard(*signal));
  EXPECT_EQ(counter.Count(), 1U) << "that of the signal alone";
}

}  // namespace
}  // namespace uplink::storage::postgres
