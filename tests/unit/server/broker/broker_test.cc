// The broker's reader: its connections, its lease, and what is heard.
#include "server/broker/broker.h"

#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/broker/limits.h"
#include "server/config/config.h"
#include "tests/unit/server/broker/broker_world.h"

namespace uplink::broker {
namespace {

using testing::FakeLink;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

class BrokerTest : public BrokerWorld {};

TEST_F(BrokerTest, HearsWhileBothConnectionsAreSubscribed) {
  using enum fleet::Fleet::HearingState;
  EXPECT_EQ(broker_.hearing(), kBehind);
  Begin();
  Up(durable());
  broker_.Tick();
  EXPECT_EQ(broker_.hearing(), kBehind) << "live state comes by the other one";
  Up(live());
  broker_.Tick();
  EXPECT_EQ(broker_.hearing(), kUpToDate);
  clock_.Advance(kTickLate);
  EXPECT_EQ(broker_.hearing(), kBehind) << "its thread stands still";
  broker_.Tick();
  EXPECT_EQ(broker_.hearing(), kUpToDate);
  live()->events()->OnDown({mqtt::EndReason::kBroken, "gone"});
  EXPECT_EQ(broker_.hearing(), kBehind);
}

TEST_F(BrokerTest, ShowsAtOnceHowItsConnectionsStand) {
  Begin();
  Up(durable());
  Up(live());
  EXPECT_EQ(broker_.subscribed_since(), clock_.System());
  EXPECT_EQ(broker_.hearing(), fleet::Fleet::HearingState::kUpToDate);
  ASSERT_THAT(broker_.connections(), SizeIs(2));
  for (const ConnectionStatus& connection : broker_.connections()) {
    EXPECT_EQ(connection.client.state, mqtt::ClientState::kSubscribed) << connection.client_id;
  }
  live()->events()->OnDown({mqtt::EndReason::kBroken, "gone"});
  EXPECT_NE(broker_.connections().at(1).client.state, mqtt::ClientState::kSubscribed);
}

TEST_F(BrokerTest, ConnectsAgainOnlyWhenTheLeaseIsOurs) {
  Connect();
  lease_.may_connect = false;
  durable()->events()->OnDown({mqtt::EndReason::kBroken, "gone"});
  EXPECT_EQ(lease_.looks, 1);
  const std::shared_ptr<FakeLink> again = links_.back();
  for (int i = 0; i < 400; ++i) {
    clock_.Advance(milliseconds(250));
    again->events()->OnDue();
    ASSERT_FALSE(again->opened);
  }
  lease_.may_connect = true;
  clock_.Advance(milliseconds(250));
  again->events()->OnDue();
  EXPECT_TRUE(again->opened);
}

TEST_F(BrokerTest, WithTheJournalFullNothingMoreIsReadUntilThereIsRoom) {
  Connect();
  for (std::size_t id = 1; id <= 3; ++id) durable()->Bring(Event(static_cast<int>(id), id));
  durable()->Bring(Event(4, 4) + Event(5, 5));
  EXPECT_EQ(broker_.probe().held_back.value(), 1);
  EXPECT_FALSE(durable()->reading);
  EXPECT_EQ(broker_.ledger().Read().messages.received, 4U) << "the fifth lies unread";
  live()->Bring(testing::PublishBytes{
      .topic = "cyberwave/ping/a/request", .payload = R"({"type":"ping"})", .mqtt5 = false}
                    .Text());
  Flush(*live());
  EXPECT_THAT(live()->written, HasSubstr("cyberwave/pong/a/response"));
  Run();
  Run();
  Flush(*durable());
  EXPECT_EQ(durable()->written, Puback(1) + Puback(2) + Puback(3) + Puback(4) + Puback(5));
  EXPECT_TRUE(durable()->reading);
  EXPECT_EQ(Stored(), 5U);
}

TEST_F(BrokerTest, WhatIsLiveGoesPastAMessageThatIsHeld) {
  Connect();
  store_.FailNextCommits(1'000, testing::FailAt::kBefore);
  for (std::size_t id = 1; id <= 4; ++id) durable()->Bring(Event(static_cast<int>(id), id));
  ASSERT_EQ(broker_.probe().held_back.value(), 1);
  const std::string live_message =
      testing::PublishBytes{.topic = std::string("cyberwave/twin/") + kTwin + "/position",
                            .payload = R"({"position":{"x":1,"y":2,"z":3}})",
                            .mqtt5 = false}
          .Text();
  for (int i = 0; i < 3; ++i) {
    live()->Bring(live_message);
    broker_.Tick();
  }
  EXPECT_EQ(broker_.probe().held_back.value(), 1);
  EXPECT_EQ(broker_.probe().held_back_total.value(), 1);
  EXPECT_EQ(broker_.ledger().Read().messages.received, 7U);
  EXPECT_EQ(broker_.ledger().Read().messages.in_flight, 4);
  EXPECT_EQ(Count(Became::kApplied), 3U);
  broker_.End();
  EXPECT_EQ(Count(Became::kRefused), 1U) << "the one that was held comes again";
  EXPECT_TRUE(broker_.ledger().Read().messages.Balanced());
}

TEST_F(BrokerTest, AConnectionThatWasHeldIsReadAgainUnderTheNextLease) {
  Connect();
  store_.FailNextCommits(1'000, testing::FailAt::kBefore);
  for (std::size_t id = 1; id <= 4; ++id) durable()->Bring(Event(static_cast<int>(id), id));
  broker_.End();
  Begin();
  Up(links_.at(2), true);
  Up(links_.at(3));
  for (int second = 0; second < 3; ++second) {
    broker_.Tick();
    clock_.Advance(std::chrono::seconds(1));
  }
  EXPECT_EQ(broker_.probe().behind.value(), 0);
  EXPECT_EQ(broker_.hearing(), fleet::Fleet::HearingState::kUpToDate);
}

TEST_F(BrokerTest, AWindowThatWasFullSinceTheLastLookMakesNobodyOffline) {
  Connect();
  std::string many;
  for (std::size_t id = 1; id <= 3; ++id) many += Event(static_cast<int>(id), id);
  durable()->Bring(many + Event(4, 4));
  Run();
  Run();
  clock_.Advance(kTickLate);
  broker_.Tick();
  EXPECT_EQ(broker_.hearing(), fleet::Fleet::HearingState::kBehind) << "more may lie at the broker";
  broker_.Tick();
  EXPECT_EQ(broker_.hearing(), fleet::Fleet::HearingState::kUpToDate);
}

TEST_F(BrokerTest, WhileNothingIsReadWeAreBehind) {
  Connect();
  store_.FailNextCommits(1'000, testing::FailAt::kBefore);
  for (std::size_t id = 1; id <= 4; ++id) durable()->Bring(Event(static_cast<int>(id), id));
  for (int second = 0; second < 5; ++second) {
    broker_.Tick();
    clock_.Advance(std::chrono::seconds(1));
  }
  EXPECT_EQ(broker_.probe().behind.value(), 1);
  EXPECT_EQ(broker_.hearing(), fleet::Fleet::HearingState::kBehind);
}

TEST_F(BrokerTest, TellsTheStoreWhatIsOverEachSecondAndWhenItEnds) {
  const auto known = [this] { return leases_.MemoryOf("core")->known.size(); };
  const auto without_news = [this](std::size_t id) {
    durable()->Bring(
        testing::PublishBytes{.topic = std::string("cyberwave/twin/") + kTwin + "/metrics",
                              .payload = R"({"metrics":{"load":{"cpu":1}}})",
                              .id = id,
                              .mqtt5 = false}
            .Text());
  };
  Connect();
  for (std::size_t id = 1; id <= 3; ++id) {
    durable()->Bring(Event(static_cast<int>(id), id));
    Run();
  }
  EXPECT_EQ(known(), 3U);
  without_news(1);
  Run();
  EXPECT_EQ(known(), 3U);
  broker_.Tick();
  Run();
  EXPECT_EQ(known(), 2U);
  without_news(2);
  broker_.BeginDrain();
  Run();
  EXPECT_EQ(known(), 1U);
}

TEST_F(BrokerTest, AConnectionThatIsBackBeforeASweepMakesNobodyOffline) {
  Connect();
  live()->Bring(
      testing::PublishBytes{.topic = std::string("cyberwave/twin/") + kTwin + "/position",
                            .payload = R"({"source_type":"edge","position":{"x":1,"y":2,"z":3}})",
                            .mqtt5 = false}
          .Text());
  const auto presence = [this] {
    return fleet_.Find("rcan://local.rcan/cyberwave/twin/" + std::string(kTwin))->state.presence();
  };
  const milliseconds timeout = config::CyberwaveConfig().presence_timeout;
  const auto pass = [this](milliseconds time) {
    for (milliseconds passed{0}; passed < time; passed += std::chrono::seconds(1)) {
      clock_.Advance(std::chrono::seconds(1));
      broker_.Tick();
      static_cast<void>(fleet_.Sweep(std::chrono::hours(1), fleet::Fleet::HearingState::kUpToDate,
                                     broker_.hearing()));
    }
  };
  pass(timeout - std::chrono::seconds(2));
  EXPECT_EQ(presence(), robot::Presence::kOnline);
  live()->events()->OnDown({mqtt::EndReason::kBroken, "gone"});
  clock_.Advance(milliseconds(500));
  links_.back()->events()->OnDue();
  Up(links_.back());
  pass(std::chrono::seconds(4));
  EXPECT_EQ(presence(), robot::Presence::kUnknown) << "it may have spoken meanwhile";
  pass(timeout);
  EXPECT_EQ(presence(), robot::Presence::kOffline);
}

TEST_F(BrokerTest, ALiveConnectionThatIsLongBehindIsMadeAnew) {
  Connect();
  live()->unread_bytes = kLiveBehindBytes;
  const auto pass = [this](std::chrono::seconds seconds) {
    for (std::chrono::seconds passed{0}; passed < seconds; passed += std::chrono::seconds(1)) {
      clock_.Advance(std::chrono::seconds(1));
      broker_.Tick();
    }
  };
  pass(kLiveBehindMax);
  EXPECT_FALSE(live()->closed);
  pass(std::chrono::seconds(1));
  EXPECT_TRUE(live()->closed);
  EXPECT_FALSE(durable()->closed) << "what is at QoS 1 goes on";
  EXPECT_EQ(broker_.client_probe(Connection::kLive)
                .ended[static_cast<std::size_t>(mqtt::EndReason::kBehind)]
                .value(),
            1);
  EXPECT_THAT(broker_.connections()[1].client.last_error,
              ::testing::HasSubstr("at each look of 10 s more than 128 KiB lay unread"));
  EXPECT_NE(broker_.hearing(), fleet::Fleet::HearingState::kUpToDate);

  clock_.Advance(std::chrono::seconds(1));
  links_.back()->events()->OnDue();
  Up(links_.back());
  pass(std::chrono::seconds(1));
  EXPECT_EQ(broker_.hearing(), fleet::Fleet::HearingState::kUpToDate);
}

TEST_F(BrokerTest, WithoutTheLeaseItTakesLeaveAndForgets) {
  Connect();
  durable()->Bring(Event(1, 5));
  Run();
  EXPECT_EQ(twins_.size(), 1U);
  EXPECT_TRUE(broker_.holds_lease());
  broker_.End();
  EXPECT_FALSE(broker_.holds_lease());
  EXPECT_TRUE(durable()->closed);
  EXPECT_TRUE(live()->closed);
  EXPECT_EQ(twins_.size(), 0U);
  EXPECT_FALSE(fleet_.All().at(0)->HasStream());
}

TEST_F(BrokerTest, WhoTakesTheLeaseHoldsTheTwinsThatItKnows) {
  static_cast<void>(*fleet_.FindOrAdmit(
      {.ruri = std::string("rcan://local.rcan/cyberwave/twin/") + kTwin, .fleet = "arms"}));
  static_cast<void>(*fleet_.FindOrAdmit({.ruri = "rcan://local.rcan/other/r1", .fleet = "arms"}));
  Begin();
  Run();
  EXPECT_TRUE(fleet_.All().at(0)->HasStream());
  EXPECT_NE(fleet_.All().at(0)->state.held_since(), 0U);
  EXPECT_FALSE(fleet_.All().at(1)->HasStream()) << "it streams by the relay, or not at all";
}

TEST_F(BrokerTest, SubscriptionsOfAPrefixThatIsGoneAreTakenBackOnce) {
  Connect();
  const std::string stray =
      testing::PublishBytes{.topic = std::string("old/cyberwave/twin/") + kTwin + "/event",
                            .payload = "{}",
                            .id = 5,
                            .mqtt5 = false}
          .Text();
  durable()->Bring(stray);
  EXPECT_THAT(durable()->written, HasSubstr("old/cyberwave/twin/+/event"));
  EXPECT_EQ(static_cast<unsigned char>(durable()->written[0]) >> 4U, 10U) << "UNSUBSCRIBE";
  Flush(*durable());
  EXPECT_THAT(durable()->written, HasSubstr(Puback(5)));
  EXPECT_EQ(Count(Became::kIgnored), 1U);
  durable()->written.clear();
  durable()->Bring(stray);
  Flush(*durable());
  EXPECT_THAT(durable()->written, Not(HasSubstr("old/")));
}

TEST_F(BrokerTest, ADrainReadsNothingMoreAndAcksWhatWaits) {
  Connect();
  durable()->Bring(Event(1, 5));
  broker_.BeginDrain();
  durable()->Bring(Event(2, 6));
  EXPECT_EQ(broker_.ledger().Read().messages.received, 1U) << "the second lies unread";
  EXPECT_EQ(broker_.waiting(), 1U);
  Run();
  Flush(*durable());
  EXPECT_EQ(durable()->written, Puback(5));
  EXPECT_EQ(broker_.waiting(), 0U);
}

}  // namespace
}  // namespace uplink::broker
