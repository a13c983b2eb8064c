#include "storage/origin.h"

#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "schema/base/utf8.h"
#include "storage/numbers.h"

namespace uplink::storage {
namespace {

using model::MessageSource;

TEST(Origin, NoneIsTheRelay) {
  EXPECT_EQ(SourceOf(nullptr), MessageSource::kUplink);
  EXPECT_EQ(TopicOf(nullptr), "");
  const OriginRef origin = OriginOf(MessageSource::kCyberwave, "a/b");
  EXPECT_EQ(SourceOf(origin), MessageSource::kCyberwave);
  EXPECT_EQ(TopicOf(origin), "a/b");
}

TEST(Origin, ATopicIsKeptFitForAColumn) {
  const std::string longest(kTopicBytesMax, 'x');
  EXPECT_EQ(TopicOf(OriginOf(MessageSource::kCyberwave, longest)), longest);
  EXPECT_EQ(TopicOf(OriginOf(MessageSource::kCyberwave, longest + "y")).size(), kTopicBytesMax);
  for (const std::string& topic :
       {std::string("a\0b", 3), std::string("\xFF/x"), std::string("\n")}) {
    EXPECT_TRUE(IsCleanUtf8(TopicOf(OriginOf(MessageSource::kCyberwave, topic))));
  }
}

TEST(Origin, NoRuriStandsForNoRobot) {
  EXPECT_TRUE(IsNoRobot(NoRobotOf("")));
  EXPECT_TRUE(IsNoRobot(NoRobotOf("local/")));
  EXPECT_NE(NoRobotOf("a"), NoRobotOf("b"));
  EXPECT_FALSE(IsNoRobot("rcan://local.rcan/cyberwave/twin/T"));
}

TEST(MessageSource, TextsLeadBack) {
  for (const MessageSource source : model::kAllMessageSources) {
    EXPECT_EQ(model::MessageSourceFromText(ToText(source)), source);
    EXPECT_EQ(MessageSourceOf(static_cast<std::int64_t>(source)), source);
  }
  EXPECT_FALSE(model::MessageSourceFromText("Cyberwave"));
  EXPECT_FALSE(model::MessageSourceFromText(""));
  EXPECT_EQ(MessageSourceOf(model::kAllMessageSources.size()), MessageSource::kUplink);
}

}  // namespace
}  // namespace uplink::storage
