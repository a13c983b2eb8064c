#include "server/ingest/port.h"

#include <memory>
#include <numeric>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/robot/limits.h"
#include "tests/unit/server/journal/recording_client.h"
#include "tests/unit/server/session/session_bench.h"

namespace uplink::ingest {
namespace {

using metrics::Became;
using session::BenchLimits;
using session::BenchServer;
using session::SessionOf;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Answer = Port::Answer;

/// A message that says of itself what a test wants, and writes down what the port asked of it.
class SaidMessage final : public Message {
 public:
  /// `seq`: the last number of its stream.
  SaidMessage(robot::Robot& robot, const Arrival& arrival, model::Seq& seq)
      : robot_(robot), arrival_(arrival), seq_(seq) {}

  [[nodiscard]] const Arrival& arrival() const override { return arrival_; }
  [[nodiscard]] std::optional<RecordCost> Cost() override { return cost; }
  void Begin() override { asked.emplace_back("begin"); }
  [[nodiscard]] std::optional<model::Rejection> TakeRate() override {
    if (!over_rate) return std::nullopt;
    return model::Rejection{.reason = model::RejectReason::kRateLimited, .field = {}, .detail = {}};
  }
  [[nodiscard]] Numbered RejectLimited(const model::Rejection& /*rejection*/) override {
    asked.emplace_back("limited");
    return limited_as;
  }
  [[nodiscard]] const model::Rejection* FindRejection() override {
    return rejection ? &*rejection : nullptr;
  }
  [[nodiscard]] Quarantined Reject(const model::Rejection& /*rejection*/) override {
    asked.emplace_back("reject");
    return {.payload_may_be_kept = true, .flow_bytes = rejection_flow};
  }
  [[nodiscard]] Brought Take() override {
    asked.emplace_back("take");
    Brought brought{.records = {}, .flow_bytes = flow_bytes};
    for (std::size_t i = 0; i < records; ++i) {
      brought.records.push_back(
          {.content = storage::QuarantineItem{}, .payload = {}, .payload_bytes = 1});
    }
    if (records == 0) brought.became = live_became;
    return brought;
  }
  [[nodiscard]] Numbered Number(std::vector<storage::CommitRecord>& numbered,
                                std::optional<model::RejectReason> /*rejected*/) override {
    asked.emplace_back("number");
    if (is_lost) return Numbered::kLost;
    for (storage::CommitRecord& record : numbered) {
      record.seq = ++seq_;
      record.sample = mark;
      EXPECT_EQ(robot_.sessions.AddWaiting(record.session, record.seq, journal::CostOf(record)), 1);
    }
    return Numbered::kWaiting;
  }
  void Settle(Became became) override { settled = became; }

  std::optional<RecordCost> cost = RecordCost{.journal_bytes = 100, .flow_bytes = 1};
  bool over_rate = false;
  Numbered limited_as = Numbered::kSettled;
  std::optional<model::Rejection> rejection;
  std::optional<std::size_t> rejection_flow;
  std::optional<std::size_t> flow_bytes = 1;
  std::size_t records = 1;
  Became live_became = Became::kApplied;
  bool is_lost = false;
  storage::SampleRef mark;
  std::vector<std::string> asked;
  std::optional<Became> settled;

 private:
  robot::Robot& robot_;
  const Arrival arrival_;
  model::Seq& seq_;
};

constexpr std::string_view kPayload = "what a robot said";

class PortTest : public ::testing::Test {
 protected:
  PortTest() { static_cast<void>(robot_.sessions.Begin(SessionOf(1), clock_.Steady())); }

  Arrival Arrived(Waits waits) {
    return {.steady = clock_.Steady(),
            .system = clock_.System(),
            .payload = kPayload,
            .payload_bytes = kPayload.size(),
            .waits = waits};
  }
  Port::Offered Offer(SaidMessage& message) {
    const Port::Offered offered = port_.Offer(line_, message);
    if (offered.answer == Answer::kWaits) {
      EXPECT_EQ(port_.counts().received, 0U) << "nothing is done";
      EXPECT_THAT(message.asked, IsEmpty());
    }
    port_.Publish();
    EXPECT_TRUE(ledger_.Read().messages.Balanced());
    return offered;
  }
  [[nodiscard]] metrics::MessageCounts Counts() const { return ledger_.Read().messages; }
  /// The robot's flow is at its end.
  void ExhaustFlow() {
    for (int i = 0; i < 2; ++i) robot_.flow.Take(1, flow_, clock_.Steady());
  }

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  BenchLimits limits_{.journal = {.records_max = 8, .robot_share = 1}};
  BenchServer server_{clock_, database_, 1, limits_};
  const robot::PresenceChanged changed_;
  robot::Robot robot_{
      std::make_shared<const model::RobotId>(model::RobotId{std::string(session::kRobot)}),
      clock_.Steady(), clock_, changed_};
  const robot::FlowLimits flow_{.records = {.rate = 1, .burst = 2}, .bytes = {}};
  const Allowances allowances_{{.flow = flow_}};
  metrics::Ledger ledger_;
  bool over_half_ = false;
  model::Seq seq_ = 0;
  Port port_{{.clock = clock_,
              .fleet = server_.fleet(),
              .ledger = ledger_,
              .allowances = allowances_,
              .in_flight_max = 4,
              .payload_bytes_max = 8,
              .journal_over_half = [this] { return over_half_; }}};
  const Line line_{.robot = robot_,
                   .id = robot_.id(),
                   .journal = server_.journal(),
                   .session = SessionOf(1),
                   .by = {0}};
};

struct Case {
  std::string_view name;
  Waits waits;
  enum class Content : std::uint8_t { kLive, kDurable, kRejected } content;
  enum class Room : std::uint8_t { kFree, kJournalFull, kFlowPast, kDiskFull } room;
  bool over_rate = false;
  bool is_lost = false;
  Answer answer;
  /// What it became; nothing: it waits for room, or for its commit.
  std::optional<Became> became;
};

using enum Case::Content;
using enum Case::Room;
using enum Waits;

constexpr Case kCases[] = {
    {"live of a stream", kStream, kLive, kFree, false, false, Answer::kTaken, Became::kApplied},
    {"live without room", kStream, kLive, kJournalFull, false, false, Answer::kTaken,
     Became::kApplied},
    {"durable of a stream", kStream, kDurable, kFree, false, false, Answer::kTaken, {}},
    {"a stream in a full journal",
     kStream,
     kDurable,
     kJournalFull,
     false,
     false,
     Answer::kWaits,
     {}},
    {"a stream past its flow", kStream, kDurable, kFlowPast, false, false, Answer::kWaits, {}},
    {"a stream on a full disk", kStream, kDurable, kDiskFull, false, false, Answer::kWaits, {}},
    {"a stream over its rate", kStream, kDurable, kFree, true, false, Answer::kLimited,
     Became::kRejected},
    {"live over its rate", kStream, kLive, kFree, true, false, Answer::kLimited, Became::kRejected},
    {"rejected of a stream", kStream, kRejected, kFree, false, false, Answer::kTaken, {}},
    {"a stream whose robot is lost", kStream, kDurable, kFree, false, true, Answer::kTaken,
     Became::kRefused},
    {"a broker's", kBroker, kDurable, kFree, false, false, Answer::kTaken, {}},
    {"a broker's in a full journal",
     kBroker,
     kDurable,
     kJournalFull,
     false,
     false,
     Answer::kWaits,
     {}},
    {"a broker's past the flow", kBroker, kDurable, kFlowPast, false, false, Answer::kTaken, {}},
    {"a broker's on a full disk", kBroker, kDurable, kDiskFull, false, false, Answer::kWaits, {}},
    {"a broker's whose robot is lost", kBroker, kDurable, kFree, false, true, Answer::kTaken,
     Became::kRefused},
    {"without a waiting sender", kNoOne, kDurable, kFree, false, false, Answer::kTaken, {}},
    {"without a waiting sender in a full journal", kNoOne, kDurable, kJournalFull, false, false,
     Answer::kRefused, Became::kRefused},
    {"without a waiting sender past the flow", kNoOne, kDurable, kFlowPast, false, false,
     Answer::kLimited, Became::kRejected},
    {"without a waiting sender on a full disk", kNoOne, kDurable, kDiskFull, false, false,
     Answer::kRefused, Became::kRefused},
    {"rejected without a waiting sender in a full journal", kNoOne, kRejected, kJournalFull, false,
     false, Answer::kRefused, Became::kRefused},
};

class PortTable : public PortTest, public ::testing::WithParamInterface<Case> {
 protected:
  void MakeRoom(Case::Room room) {
    if (room == kFlowPast) ExhaustFlow();
    if (room == kDiskFull) robot_.flow.LimitForDisk(0);
    if (room != kJournalFull) return;
    for (model::Seq seq = 1; seq <= limits_.journal.records_max; ++seq) {
      server_.journal().AppendMessage(robot_, 0,
                                      {{.robot = robot_.id(),
                                        .session = SessionOf(2),
                                        .seq = seq,
                                        .content = storage::QuarantineItem{},
                                        .payload = {}}},
                                      clock_.Steady());
    }
  }
};

TEST_P(PortTable, Holds) {
  const Case& c = GetParam();
  MakeRoom(c.room);
  SaidMessage message(robot_, Arrived(c.waits), seq_);
  message.over_rate = c.over_rate;
  message.is_lost = c.is_lost;
  if (c.content == kLive) {
    message.cost.reset();
    message.records = 0;
  }
  if (c.content == kRejected) {
    message.rejection = model::Rejection{.reason = model::RejectReason::kMalformed};
    message.cost->flow_bytes.reset();
  }
  EXPECT_EQ(Offer(message).answer, c.answer) << c.name;
  const metrics::MessageCounts counts = Counts();
  const bool waits = c.answer == Answer::kWaits;
  EXPECT_EQ(counts.received, waits ? 0U : 1U) << c.name;
  EXPECT_EQ(counts.in_flight, waits || c.became ? 0 : 1) << c.name;
  if (!c.became) return;
  EXPECT_EQ(counts.*metrics::kBecame.at(static_cast<std::size_t>(*c.became)).count, 1U) << c.name;
}

INSTANTIATE_TEST_SUITE_P(Port, PortTable, ::testing::ValuesIn(kCases));

TEST_F(PortTest, AsksInItsOrder) {
  SaidMessage message(robot_, Arrived(kStream), seq_);
  Offer(message);
  EXPECT_THAT(message.asked, ElementsAre("begin", "take", "number"));
  SaidMessage rejected(robot_, Arrived(kStream), seq_);
  rejected.rejection = model::Rejection{.reason = model::RejectReason::kMalformed};
  Offer(rejected);
  EXPECT_THAT(rejected.asked, ElementsAre("begin", "reject", "number"));
  SaidMessage limited(robot_, Arrived(kStream), seq_);
  limited.over_rate = true;
  limited.rejection = rejected.rejection;
  Offer(limited);
  EXPECT_THAT(limited.asked, ElementsAre("begin", "limited"));
}

TEST_F(PortTest, ALimitedMessageWhoseNumberWaitsIsInFlight) {
  SaidMessage message(robot_, Arrived(kStream), seq_);
  message.over_rate = true;
  message.limited_as = Numbered::kWaiting;
  EXPECT_EQ(Offer(message).answer, Answer::kLimited);
  EXPECT_EQ(Counts().in_flight, 1);
  EXPECT_EQ(Counts().rejected, 0U) << "its commit counts it";
}

TEST_F(PortTest, AMessageThatWaitedIsCountedOnce) {
  port_.CountHeld();
  Arrival arrival = Arrived(kBroker);
  arrival.is_counted = true;
  SaidMessage message(robot_, arrival, seq_);
  message.records = 0;
  Offer(message);
  EXPECT_EQ(Counts().received, 1U);
  EXPECT_EQ(Counts().applied, 1U);
  EXPECT_EQ(Counts().in_flight, 0);
  EXPECT_EQ(message.settled, Became::kApplied);
}

TEST_F(PortTest, CountsHowOldTakenMessagesAreByTheirSendersClock) {
  const auto offer = [this](std::int64_t sampled_unix_ms, const auto& change) {
    Arrival arrival = Arrived(kStream);
    arrival.sampled_unix_ms = sampled_unix_ms;
    SaidMessage message(robot_, arrival, seq_);
    change(message);
    Offer(message);
  };
  const auto durable = [](SaidMessage& /*message*/) {};
  const auto live = [](SaidMessage& message) { message.records = 0; };
  const std::int64_t now = UnixMs(clock_.System());
  offer(now - 2000, live);
  offer(now - 4'000'000, durable);
  offer(0, live);   // it does not say
  offer(-1, live);  // nor is that a time
  offer(now - 2000, [](SaidMessage& message) {
    message.rejection = model::Rejection{.reason = model::RejectReason::kMalformed};
  });
  offer(now - 2000, [](SaidMessage& message) { message.over_rate = true; });
  offer(now - 2000, [](SaidMessage& message) {
    message.records = 0;
    message.live_became = Became::kObserved;
  });
  const metrics::MessageAges ages = ledger_.Read().ages;
  const auto count = [&ages](metrics::AgeKind kind) {
    const auto& counts = ages[static_cast<std::size_t>(kind)].counts;
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  };
  EXPECT_EQ(count(metrics::AgeKind::kLive), 1U);
  EXPECT_DOUBLE_EQ(ages[static_cast<std::size_t>(metrics::AgeKind::kLive)].sum_seconds, 2);
  EXPECT_EQ(count(metrics::AgeKind::kDurable), 1U);
  EXPECT_DOUBLE_EQ(ages[static_cast<std::size_t>(metrics::AgeKind::kDurable)].sum_seconds, 4000);
}

TEST_F(PortTest, AllRecordsOfAMessageTakeTheFlowTogether) {
  SaidMessage message(robot_, Arrived(kStream), seq_);
  message.records = 2;
  message.flow_bytes = 700;
  Offer(message);
  EXPECT_EQ(robot_.flow.bytes_total(), 700U);
  EXPECT_EQ(server_.journal().records(), 2U);
  SaidMessage next(robot_, Arrived(kStream), seq_);
  EXPECT_EQ(Offer(next).answer, Answer::kWaits) << "two records took the whole burst";
}

TEST_F(PortTest, WhatABrokerDeliversPastTheFlowLeavesNoDebt) {
  ExhaustFlow();
  const std::uint64_t before = robot_.flow.bytes_total();
  SaidMessage message(robot_, Arrived(kBroker), seq_);
  message.flow_bytes = 5'000;
  Offer(message);
  EXPECT_EQ(robot_.flow.bytes_total(), before + 5'000) << "it is stored";
  clock_.Advance(std::chrono::seconds(1));
  SaidMessage next(robot_, Arrived(kNoOne), seq_);
  EXPECT_EQ(Offer(next).answer, Answer::kTaken);
}

TEST_F(PortTest, KeepsThePayloadOfOneRejectionOfAReasonInASecond) {
  const auto reject = [this] {
    SaidMessage message(robot_, Arrived(kStream), seq_);
    message.rejection = model::Rejection{.reason = model::RejectReason::kMalformed};
    Offer(message);
  };
  reject();
  EXPECT_EQ(robot_.flow.bytes_total(), 8U) << "payload_bytes_max of it";
  reject();
  EXPECT_EQ(robot_.flow.bytes_total(), 8U);
}

TEST_F(PortTest, KeepsNoPayloadWhileTheDiskIsShort) {
  robot_.flow.LimitForDisk(1'000'000);
  SaidMessage message(robot_, Arrived(kStream), seq_);
  message.rejection = model::Rejection{.reason = model::RejectReason::kMalformed};
  message.cost->flow_bytes.reset();
  EXPECT_EQ(Offer(message).answer, Answer::kTaken);
  EXPECT_EQ(robot_.flow.bytes_total(), 0U);
}

TEST_F(PortTest, AppendsForTheClientOfTheLine) {
  journal::RecordingClient drone{std::string(session::kRobot)};
  Line line = line_;
  line.client = &drone;
  line.by = drone.generation();
  SaidMessage message(robot_, Arrived(kStream), seq_);
  // Under a claim that does not exist.
  message.mark = std::make_shared<const storage::SampleMark>(storage::SampleMark{.claim = 99});
  EXPECT_EQ(port_.Offer(line, message).answer, Answer::kTaken);
  while (server_.Advance() == journal::Step::kWorked) {
  }
  EXPECT_THAT(drone.Told(), ElementsAre("fenced"));
}

TEST_F(PortTest, FollowsAReloadOfTheAllowance) {
  Allowances allowances{{.flow = flow_}};
  Port port({.clock = clock_,
             .fleet = server_.fleet(),
             .ledger = ledger_,
             .allowances = allowances,
             .in_flight_max = 4});
  EXPECT_EQ(port.allowance().flow.records.burst, 2U);
  allowances.Set({.flow = {.records = {.rate = 7, .burst = 9}, .bytes = {}}});
  EXPECT_EQ(port.allowance().flow.records.burst, 2U) << "until it looks";
  port.FollowReload();
  EXPECT_EQ(port.allowance().flow.records.burst, 9U);
}

}  // namespace
}  // namespace uplink::ingest
