// Who is refused, sent away or short of places is counted, and named in the log.
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/front/door/evictions.h"
#include "server/front/door/place.h"
#include "server/transport/descriptors.h"
#include "tests/component/front/front_world.h"
#include "tests/component/front/shared_lines.h"

namespace uplink::testing {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Matches;
using ::testing::SizeIs;
using transport::TurnedAway;

class Naming : public ::testing::Test {
 protected:
  Naming() { Make(); }

  void Make(const session::SessionLimits& limits = {}) {
    RelayWorld::Options options;
    options.session = limits;
    options.logger = &logger_;
    world_ = std::make_unique<RelayWorld>(options);
  }

  /// A call with these headers changed has ended.
  void Call(const KeyPair& keys, const http2::Fields& changes) {
    RawHttp2 client(ClientOf(*world_, keys, "127.0.0.66"));
    ASSERT_TRUE(client.Begin());
    client.Send(OpenRelay(1, changes) + http2::Data(1, HelloMessage(1)));
    EXPECT_TRUE(client.ReadUntilOver(1));
  }
  std::vector<std::string> LinesOf(const std::string& part) {
    std::vector<std::string> found;
    for (const std::string& line : lines_.All()) {
      if (line.find(part) != std::string::npos) found.push_back(line);
    }
    return found;
  }

  SharedLines::Lines lines_;
  SystemClock clock_;
  log::Logger logger_{std::make_unique<SharedLines>(lines_), clock_, log::Format::kText,
                      log::Level::kDebug};
  std::unique_ptr<RelayWorld> world_;
};

TEST_F(Naming, AnExpiredCertificateByItsRobot) {
  CertificateSpec spec = RobotSpec(RuriOf(7));
  spec.not_after_s = -60;
  Call(world_->authority.Issue(spec), {});
  EXPECT_THAT(lines_.All(),
              Contains(AllOf(HasSubstr("stream_refused source=127.0.0.66 "),
                             HasSubstr("robot=" + RuriOf(7)), HasSubstr("has expired"))));
}

TEST_F(Naming, WhoLeavesWithoutAStreamByItsRobotOrItsSubject) {
  CertificateSpec gateway;
  gateway.units = {"gateway"};
  gateway.common_names = {"gateway of hall 7"};
  CertificateSpec viewer;
  viewer.units = {"viewer"};
  viewer.common_names = {"screen of hall 7"};
  std::int64_t left = 0;
  for (const auto& [spec, words] :
       {std::pair{RobotSpec(RuriOf(7)), "robot=" + RuriOf(7) + " gateway=\"\" subject=\"\" "},
        std::pair{gateway, std::string("robot=\"\" gateway=\"CN=gateway of hall 7,OU=gateway\" "
                                       "subject=\"\" ")},
        std::pair{viewer, std::string("robot=\"\" gateway=\"\" subject=\"CN=screen of hall 7")}}) {
    { const RawHttp2 passer_by(ClientOf(*world_, world_->authority.Issue(spec))); }
    EXPECT_TRUE(Eventually([&, named = Matches(Contains(HasSubstr(words)))] {
      return named(LinesOf("why=no_stream"));
    })) << words;
    ++left;
    EXPECT_TRUE(Eventually([&] { return TurnedAwayFor(*world_, TurnedAway::kNoStream) == left; }));
  }
}

TEST_F(Naming, WhoWasRefusedAndLeavesForThatAlone) {
  const auto refused = [&] { return world_->relay_probe.refused_request_total.value(); };
  { Call(RobotKeys(*world_, 7), {{":path", "/uplink.v1.UplinkRelay/Other"}}); }
  EXPECT_EQ(refused(), 1);
  // Connections of one thread are looked at in order, so this one's end comes after.
  EXPECT_TRUE(Eventually([&] { return world_->relay_probe.connections.value() == 0; }));
  EXPECT_EQ(TurnedAwayFor(*world_, TurnedAway::kNoStream), 0);
  EXPECT_THAT(LinesOf("why=no_stream"), IsEmpty());
}

TEST_F(Naming, AnAgentThatConfirmsNoRejectByItsRobot) {
  Make({.unconfirmed_rejects_max = 2});
  RawHttp2 client(ClientOf(*world_, RobotKeys(*world_, 7), "127.0.0.66"));
  ASSERT_TRUE(client.Begin());
  const std::string bad = BatchFrame({{1, "no message"}, {2, "no message"}}).SerializeAsString();
  client.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1)) + http2::Data(1, WithPrefix(bad)));
  EXPECT_TRUE(client.ReadUntilOver(1));
  EXPECT_EQ(world_->session_probe.unconfirmed_total.value(), 1);
  EXPECT_THAT(LinesOf("rejects_unconfirmed"),
              ElementsAre(AllOf(HasSubstr("source=127.0.0.66 "), HasSubstr("robot=" + RuriOf(7)),
                                HasSubstr("2 Rejects of this session are above"))));
}

TEST_F(Naming, WhatIsNoCallOfTheRelay) {
  const auto refused = [&] { return world_->relay_probe.refused_request_total.value(); };
  const KeyPair keys = RobotKeys(*world_, 7);
  Call(keys, {{":path", "/uplink.v1.UplinkRelay/Other"}});
  EXPECT_EQ(refused(), 1);
  EXPECT_THAT(lines_.All(),
              Contains(AllOf(HasSubstr("stream_refused"), HasSubstr("robot=" + RuriOf(7)),
                             HasSubstr("no such method is served here"))));
  Call(keys, {{"content-type", "application/json"}});
  EXPECT_EQ(refused(), 2);
  EXPECT_THAT(lines_.All(), Contains(HasSubstr("HTTP 415: not a call of gRPC")));
  Call(keys, {{"grpc-encoding", "gzip"}});
  Call(keys, {{"grpc-timeout", "soon"}});
  EXPECT_EQ(refused(), 4);
  EXPECT_THAT(LinesOf("stream_refused"), SizeIs(2)) << "so many of one peer";
  Call(RobotKeys(*world_, 8), {{":path", "/"}});
  EXPECT_THAT(LinesOf("stream_refused"), Contains(HasSubstr("robot=" + RuriOf(8))));
}

TEST_F(Naming, ARequestThatBreaksTheRulesOfHttpTwo) {
  RawHttp2 client(ClientOf(*world_, RobotKeys(*world_, 7), "127.0.0.66"));
  ASSERT_TRUE(client.Begin());
  client.Send(OpenRelay(1, {{"Upper-Case", "x"}}));
  EXPECT_TRUE(client.ReadUntilOver(1));
  EXPECT_EQ(client.At(1).reset, http2::kProtocolError);
  EXPECT_TRUE(client.Sync()) << "its connection goes on";
  EXPECT_EQ(world_->relay_probe.refused_request_total.value(), 1);
  EXPECT_THAT(lines_.All(),
              Contains(AllOf(HasSubstr("stream_refused"), HasSubstr("robot=" + RuriOf(7)),
                             HasSubstr("it breaks a rule of HTTP/2: PROTOCOL_ERROR"))));
}

TEST_F(Naming, AMessageThatBreaksTheRulesOfGrpc) {
  RawHttp2 client(ClientOf(*world_, RobotKeys(*world_, 7)));
  ASSERT_TRUE(client.Begin());
  client.Send(OpenRelay(1) + http2::Data(1, std::string("\x01\0\0\0\x01x", 6)));
  EXPECT_TRUE(client.ReadUntilOver(1));
  EXPECT_THAT(lines_.All(),
              Contains(AllOf(HasSubstr("protocol_error"), HasSubstr("robot=" + RuriOf(7)),
                             HasSubstr("flagged as compressed"))));
}

/// Connections of one key, one after the other; each has its place by the time that it is here.
class NamingCrowds : public Naming {
 protected:
  void Come(std::size_t connections) {
    for (std::size_t i = 0; i < connections; ++i) {
      clients_.push_back(std::make_unique<RawHttp2>(ClientOf(*world_, keys_, "127.0.0.66")));
      ASSERT_TRUE(clients_.back()->Begin());
    }
  }
  [[nodiscard]] bool AreEvicted(std::int64_t connections) const {
    return Eventually([&] { return TurnedAwayFor(*world_, TurnedAway::kKey) == connections; });
  }

  KeyPair keys_ = RobotKeys(*world_, 7);
  std::vector<std::unique_ptr<RawHttp2>> clients_;
};

TEST_F(NamingCrowds, OneConnectionTooManyIsNoContest) {
  Come(front::kRobotConnectionsMax + 1);
  EXPECT_TRUE(AreEvicted(1));
  // A line comes after the count.
  EXPECT_TRUE(Eventually([&] { return !LinesOf("why=key").empty(); }));
  EXPECT_THAT(LinesOf("why=key"), SizeIs(1));
  EXPECT_THAT(LinesOf("connections_contested"), IsEmpty());
}

TEST_F(NamingCrowds, AKeyThatEvictsItsOwnAgainAndAgain) {
  Come(front::kRobotConnectionsMax + front::kEvictionsFlagged - 1);
  EXPECT_TRUE(AreEvicted(front::kEvictionsFlagged - 1));
  EXPECT_THAT(LinesOf("connections_contested"), IsEmpty());
  Come(1);
  EXPECT_TRUE(AreEvicted(front::kEvictionsFlagged));
  EXPECT_TRUE(Eventually([&] { return !LinesOf("connections_contested").empty(); }));
  EXPECT_THAT(LinesOf("connections_contested"),
              Contains(AllOf(HasSubstr("source=127.0.0.66 "), HasSubstr("robot=" + RuriOf(7)),
                             HasSubstr("one certificate opens connections again and again"))));
}

TEST_F(Naming, TooFewDescriptors) {
  {
    const DescriptorLimit limit(1024);
    Make();
  }
  // 1,000 streams are asked for.
  EXPECT_THAT(
      LinesOf("descriptors_few"),
      Contains(AllOf(HasSubstr("descriptors_max=1024"), HasSubstr("descriptors_wanted=7144"),
                     HasSubstr("connections_limit=384"), HasSubstr("connections_wanted=1000"))));
  EXPECT_EQ(world_->relay_probe.connections_limit.value(), 384);
}

TEST_F(Naming, DescriptorsAreFewBelowWhatIsWanted) {
  transport::RelayOptions options;
  options.streams_max = world_->options.streams_max;
  const std::size_t wanted = transport::DescriptorsWanted(options);
  const std::size_t before = LinesOf("descriptors_few").size();
  {
    const DescriptorLimit limit(wanted);
    Make();
  }
  EXPECT_THAT(LinesOf("descriptors_few"), SizeIs(before));
  {
    const DescriptorLimit limit(wanted - 1);
    Make();
  }
  EXPECT_THAT(LinesOf("descriptors_few"), SizeIs(before + 1));
}

}  // namespace
}  // namespace uplink::testing
