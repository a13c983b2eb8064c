// Which topics are ours, under which prefix, and whose.
#include "schema/cyberwave/topic.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/cyberwave/pong.h"
#include "schema/cyberwave/prefix.h"
#include "schema/cyberwave/ruri.h"
#include "schema/cyberwave/topic_kinds.h"
#include "schema/limits.h"
#include "schema/model/ids.h"
#include "tests/unit/schema/cyberwave/judging.h"

namespace uplink::cyberwave {
namespace {

using model::RejectReason;
using model::cyberwave::Uuid;
using test::kTwin;
using test::TopicOf;

const std::vector<std::string> kNoPrefix = {""};

TopicReading Parsed(const std::string& topic) { return ParseTopic(topic, kNoPrefix); }

struct Known {
  std::string tail;
  TopicKind kind;
  MessageClass message_class;
};

TEST(CyberwaveTopic, KnowsEachTopicAndItsClass) {
  const std::vector<Known> topics = {
      {"position", TopicKind::kPosition, MessageClass::kLive},
      {"rotation", TopicKind::kRotation, MessageClass::kLive},
      {"scale", TopicKind::kScale, MessageClass::kLive},
      {"joint/update", TopicKind::kJointUpdate, MessageClass::kLive},
      {"metrics", TopicKind::kMetrics, MessageClass::kLive},
      {"edge_health", TopicKind::kEdgeHealth, MessageClass::kLive},
      {"telemetry", TopicKind::kTelemetry, MessageClass::kDurable},
      {"navigate/status", TopicKind::kNavigateStatus, MessageClass::kDurable},
      {"driverlog", TopicKind::kDriverLog, MessageClass::kDurable},
      {"event", TopicKind::kEvent, MessageClass::kDurable},
      {"mission/status", TopicKind::kMissionStatus, MessageClass::kDurable},
      {"gps", TopicKind::kGps, MessageClass::kLive},
      {"joint_states", TopicKind::kJointStates, MessageClass::kLive},
      {"battery/status", TopicKind::kBatteryStatus, MessageClass::kLive},
      {"command", TopicKind::kCommand, MessageClass::kObserved},
      {"navigate/command", TopicKind::kNavigateCommand, MessageClass::kObserved},
      {"webrtc-offer", TopicKind::kWebrtcOffer, MessageClass::kObserved},
      {"webrtc-answer", TopicKind::kWebrtcAnswer, MessageClass::kObserved},
      {"webrtc-candidate", TopicKind::kWebrtcCandidate, MessageClass::kObserved},
      {"depth", TopicKind::kDepth, MessageClass::kMedia},
      {"pointcloud", TopicKind::kPointcloud, MessageClass::kMedia},
      {"environment/twin_added", TopicKind::kEnvironment, MessageClass::kDurable},
      {"workflow-run", TopicKind::kWorkflowRun, MessageClass::kDurable},
      {"ping", TopicKind::kPing, MessageClass::kPing},
  };
  EXPECT_EQ(topics.size(), TopicRows().size());
  for (const Known& known : topics) {
    const TopicReading reading = Parsed(TopicOf(known.tail));
    EXPECT_FALSE(reading.rejection) << known.tail;
    EXPECT_EQ(reading.topic.kind, known.kind) << known.tail;
    EXPECT_EQ(reading.topic.message_class, known.message_class) << known.tail;
    EXPECT_NE(ToText(known.kind), "other");
  }
}

TEST(CyberwaveTopic, PassesOverEveryOther) {
  for (const char* topic :
       {"", "cyberwave", "cyberwave/", "cyberwave/twin", "cyberwave/twin/", "other/twin/x/position",
        "Cyberwave/twin/11111111-1111-4111-8111-111111111111/position",
        "cyberwave/twin/11111111-1111-4111-8111-111111111111",
        "cyberwave/twin/11111111-1111-4111-8111-111111111111/",
        "cyberwave/twin/11111111-1111-4111-8111-111111111111/position/",
        "cyberwave/twin/11111111-1111-4111-8111-111111111111/positions",
        "cyberwave/twin/11111111-1111-4111-8111-111111111111/update",
        "cyberwave/joint/11111111-1111-4111-8111-111111111111/position",
        "cyberwave/joint/no-uuid/other", "cyberwave/pong/me/response",
        "cyberwave/environment/eeeeeeee-eeee-4eee-8eee-eeeeeeeeeeee/a/b",
        "cyberwave/workflow/eeeeeeee-eeee-4eee-8eee-eeeeeeeeeeee/status"}) {
    const TopicReading reading = Parsed(topic);
    EXPECT_EQ(reading.topic.kind, TopicKind::kOther) << topic;
    EXPECT_FALSE(reading.rejection) << topic;
  }
  EXPECT_EQ(ToText(TopicKind::kOther), "other");
}

TEST(CyberwaveTopic, RejectsAnIdThatIsNoUuid) {
  for (const std::string id :
       {"", "x", "11111111-1111-4111-8111-11111111111", "11111111-1111-4111-8111-1111111111111",
        "11111111-1111-4111-8111-11111111111g", "111111111-111-4111-8111-111111111111",
        "11111111111141118111111111111111", "{1111111-1111-4111-8111-111111111111"}) {
    for (const std::string& topic :
         {"cyberwave/twin/" + id + "/position", "cyberwave/joint/" + id + "/update",
          "cyberwave/environment/" + id + "/added", "cyberwave/workflow-run/" + id + "/status"}) {
      const TopicReading reading = Parsed(topic);
      ASSERT_TRUE(reading.rejection) << topic;
      EXPECT_EQ(reading.rejection->reason, RejectReason::kMalformed) << topic;
      EXPECT_NE(reading.topic.kind, TopicKind::kOther) << topic;
    }
  }
}

TEST(CyberwaveTopic, KeepsIdsInLowerCase) {
  const TopicReading reading = Parsed("cyberwave/twin/AAAAAAAA-bbbb-4CCC-8ddd-EEEEEEEEEEEF/scale");
  ASSERT_FALSE(reading.rejection);
  EXPECT_EQ(reading.topic.id.ToText(), "aaaaaaaa-bbbb-4ccc-8ddd-eeeeeeeeeeef");
  EXPECT_EQ(reading.topic.id, Uuid::FromText("aaaaaaaa-bbbb-4ccc-8ddd-eeeeeeeeeeef"));
}

TEST(CyberwaveTopic, ReadsOfAllCharactersTheDigitsOfHex) {
  constexpr std::string_view kDigits = "0123456789abcdefABCDEF";
  for (unsigned each = 0; each < 256; ++each) {
    const auto character = static_cast<char>(each);
    for (const std::size_t at : {std::size_t{0}, std::size_t{35}}) {
      std::string text = "11111111-1111-4111-8111-111111111111";
      text[at] = character;
      const bool digit = kDigits.find(character) != std::string_view::npos;
      const std::optional<Uuid> read = Uuid::FromText(text);
      ASSERT_EQ(read.has_value(), digit) << each;
      text[at] = static_cast<char>(std::tolower(static_cast<int>(each)));
      EXPECT_EQ(read ? read->ToText() : text, text);
    }
  }
}

TEST(CyberwaveTopic, ReadsNamesUpToTheirLimit) {
  const std::string environment = "cyberwave/environment/" + std::string(test::kEnvironment) + "/";
  const auto name = [](std::size_t bytes) { return std::string(bytes, 'x'); };
  EXPECT_EQ(Parsed(environment + name(schema::kNameBytesMax)).topic.name.size(),
            schema::kNameBytesMax);
  EXPECT_EQ(Parsed(environment + name(schema::kNameBytesMax + 1)).rejection->reason,
            RejectReason::kTextTooLong);
  EXPECT_EQ(Parsed(environment).rejection->reason, RejectReason::kMalformed);
  EXPECT_EQ(Parsed("cyberwave/ping/" + name(128) + "/request").topic.name, name(128));
  EXPECT_EQ(Parsed("cyberwave/ping/" + name(129) + "/request").rejection->reason,
            RejectReason::kTextTooLong);
  EXPECT_EQ(Parsed("cyberwave/ping//request").rejection->reason, RejectReason::kMalformed);
  EXPECT_EQ(Parsed("cyberwave/ping/+/request").rejection->reason, RejectReason::kMalformed);
  EXPECT_EQ(Parsed("cyberwave/ping/\xFF/request").rejection->reason, RejectReason::kTextNotUtf8);
}

TEST(CyberwaveTopic, StandsUnderAPrefix) {
  const std::vector<std::string> prefixes = {"local", "site/a/", "x"};
  const std::string rest = "cyberwave/twin/" + std::string(kTwin) + "/position";
  EXPECT_EQ(ParseTopic("local" + rest, prefixes).topic.prefix, "local");
  EXPECT_EQ(ParseTopic("site/a/" + rest, prefixes).topic.prefix, "site/a/");
  for (const std::string before : {"", "local/", "site/a", "site/", "y", "xlocal"}) {
    EXPECT_EQ(ParseTopic(before + rest, prefixes).topic.kind, TopicKind::kOther) << before;
  }
}

TEST(CyberwaveTopic, StandsUnderTheLongestPrefixThatFits) {
  const std::string rest = "cyberwave/twin/" + std::string(kTwin) + "/position";
  const std::vector<std::string> prefixes = {"", "cyberwave/"};
  const Topic topic = ParseTopic("cyberwave/" + rest, prefixes).topic;
  EXPECT_EQ(topic.prefix, "cyberwave/");
  EXPECT_EQ(topic.kind, TopicKind::kPosition);
  EXPECT_EQ(ParseTopic(rest, prefixes).topic.prefix, "");
}

TEST(CyberwaveFilters, AreThoseOfTheTopicsOfAConnection) {
  EXPECT_THAT(Filters("", Connection::kDurable),
              testing::UnorderedElementsAre(
                  "cyberwave/twin/+/metrics", "cyberwave/twin/+/telemetry",
                  "cyberwave/twin/+/navigate/status", "cyberwave/twin/+/driverlog",
                  "cyberwave/twin/+/event", "cyberwave/twin/+/mission/status",
                  "cyberwave/environment/+/+", "cyberwave/workflow-run/+/status"));
  EXPECT_THAT(Filters("site/a/", Connection::kMedia),
              testing::UnorderedElementsAre("site/a/cyberwave/twin/+/depth",
                                            "site/a/cyberwave/twin/+/pointcloud"));
  const std::vector<std::string> live = Filters("local", Connection::kLive);
  EXPECT_THAT(live,
              testing::IsSupersetOf(
                  {"localcyberwave/twin/+/position", "localcyberwave/joint/+/update",
                   "localcyberwave/twin/+/navigate/command", "localcyberwave/ping/+/request"}));
  EXPECT_EQ(live.size() + 10, TopicRows().size());
}

TEST(CyberwaveRuri, NamesTheRealAndTheSimulatedRobot) {
  const Uuid twin = *Uuid::FromText(kTwin);
  const std::string id(kTwin);
  EXPECT_EQ(TwinRuri("", twin, RobotKind::kReal), "rcan://local.rcan/cyberwave/twin/" + id);
  EXPECT_EQ(TwinRuri("", twin, RobotKind::kSimulated), "rcan://local.rcan/cyberwave/sim/" + id);
  EXPECT_EQ(TwinRuri("local", twin, RobotKind::kReal),
            "rcan://local.rcan/cyberwave/twin.local/" + id);
  EXPECT_EQ(TwinRuri("site/a b%\xC3\xBC/", twin, RobotKind::kSimulated),
            "rcan://local.rcan/cyberwave/sim.site%2Fa%20b%25%C3%BC%2F/" + id);
}

TEST(CyberwaveRuri, IsToldFromOthers) {
  const Uuid twin = *Uuid::FromText(kTwin);
  for (const std::string prefix : {"", "local", "twin/"}) {
    EXPECT_TRUE(IsTwinRuri(TwinRuri(prefix, twin, RobotKind::kReal)));
    EXPECT_TRUE(IsTwinRuri(TwinRuri(prefix, twin, RobotKind::kSimulated)));
  }
  EXPECT_FALSE(IsTwinRuri("rcan://local.rcan/acme/arm/1"));
  EXPECT_FALSE(IsTwinRuri("rcan://local.rcan/cyberwave/arm/1"));
  EXPECT_FALSE(IsTwinRuri("rcan://local.rcan/cyberwave/twins/1"));
  EXPECT_FALSE(IsTwinRuri("rcan://local.rcan/cyberwave/twin"));
}

TEST(CyberwavePrefix, FitsARuriAtItsLimitAndNotPastIt) {
  const std::string longest(kPrefixEncodedBytesMax, 'x');
  EXPECT_EQ(PrefixError(longest), "");
  EXPECT_EQ(TwinRuri(longest, Uuid(), RobotKind::kReal).size(), model::kRuriBytesMax);
  EXPECT_NE(PrefixError(longest + "x"), "");
  EXPECT_EQ(PrefixError(std::string(kPrefixEncodedBytesMax / 3, '/')), "");
  EXPECT_NE(PrefixError(std::string(kPrefixEncodedBytesMax / 3 + 1, '/')), "");
}

TEST(CyberwavePrefix, IsPartOfATopic) {
  for (const char* good : {"", "local", "site/a/", "/", "a.b-c", "\xC3\xBC"}) {
    EXPECT_EQ(PrefixError(good), "") << good;
  }
  for (const std::string bad : {"+/", "a#", "$share/group/", "\x01", "\xFF"}) {
    EXPECT_NE(PrefixError(bad), "") << bad;
  }
  EXPECT_NE(PrefixError(std::string(1, '\0')), "");
}

TEST(CyberwavePong, AnswersUnderThePrefixByTheNameAsItCame) {
  const std::vector<std::string> prefixes = {"site/a/"};
  const Topic ping = ParseTopic("site/a/cyberwave/ping/Me 1/request", prefixes).topic;
  EXPECT_EQ(PongTopic(ping), "site/a/cyberwave/pong/Me 1/response");
  EXPECT_EQ(PongPayload(FromUnixMs(1'795'362'444'007)),
            R"({"type":"pong","timestamp":1795362444.007})");
}

}  // namespace
}  // namespace uplink::cyberwave
