#include <functional>
#include <string>
#include <string_view>

#include <capnp/message.h>
#include <capnp/serialize.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/limits.h"
#include "schema/nexus_command.capnp.h"
#include "schema/nexus_command/decode.h"
#include "schema/nexus_command/encode.h"
#include "tests/unit/schema/samples.h"

/// Bytes that the server never sends: reading them must end in an error that says what is wrong.
namespace uplink::nexus_command {
namespace {

constexpr std::string_view kOrigin = "rcan://local.rcan/acme/mower/1";

/// The error of a command that `fill` built, or an empty text.
std::string ErrorOf(const std::function<void(wire::NexusCommand::Builder)>& fill) {
  capnp::MallocMessageBuilder builder;
  auto command = builder.initRoot<wire::NexusCommand>();
  command.initId(CommandId{}.size());
  fill(command);
  const auto words = capnp::messageToFlatArray(builder);
  const auto bytes = words.asChars();
  return std::string(Decode({bytes.begin(), bytes.size()}).status().message());
}

void ExpectError(const std::function<void(wire::NexusCommand::Builder)>& fill,
                 std::string_view what) {
  EXPECT_THAT(ErrorOf(fill), testing::HasSubstr(std::string(what)));
}

TEST(NexusCommandFaultsTest, NamesAnIdThatIsNoUuid) {
  ExpectError([](auto command) { command.initId(15); }, "its id has 15 bytes, not 16");
  ExpectError([](auto command) { command.initId(17); }, "its id has 17 bytes, not 16");
}

TEST(NexusCommandFaultsTest, NamesWhatIsANullPointer) {
  ExpectError([](auto) {}, "command is a null pointer");
  ExpectError(
      [](auto command) { command.initCommand().adoptFeature(capnp::Orphan<wire::FeatureOp>()); },
      "feature is a null pointer");
  ExpectError(
      [](auto command) { command.initCommand().adoptObject(capnp::Orphan<wire::ObjectOp>()); },
      "object is a null pointer");
  ExpectError([](auto command) { command.initCommand().initFeature(); },
              "upsert is a null pointer");
  ExpectError([](auto command) { command.initCommand().initFeature().initUpsert(); },
              "upsert.shape is a null pointer");
  ExpectError([](auto command) { command.initCommand().initFeature().initUpsert().initShape(); },
              "upsert.shape.data is a null pointer");
}

TEST(NexusCommandFaultsTest, NamesMembersThatAreNotSent) {
  ExpectError([](auto command) { command.initCommand().setStop(); }, "union member 3");
  ExpectError([](auto command) { command.initCommand().initTeleopJoy(); }, "union member 13");
  ExpectError([](auto command) { command.initCommand().initFeature().initUpsert().initRoute(); },
              "upsert: union member 1");
}

TEST(NexusCommandFaultsTest, NamesContentThatNoRobotMayReport) {
  model::ReportedShape shape = test::SampleShape();
  shape.data = model::GeoPoint2{181, 0};
  EXPECT_THAT(std::string(Decode(EncodeUpsert({}, shape, kOrigin)).status().message()),
              testing::HasSubstr("upsert.shape.data.point"));
}

TEST(NexusCommandFaultsTest, RefusesEveryTruncationAndWhatFollows) {
  const std::string whole = EncodeUpsert({}, test::SampleShape(), kOrigin);
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    EXPECT_FALSE(Decode(whole.substr(0, bytes)).ok()) << bytes;
  }
  EXPECT_TRUE(Decode(whole).ok());
  EXPECT_FALSE(Decode(whole + std::string(8, '\0')).ok());
}

/// Any one byte may be anything: what matters is that reading ends.
TEST(NexusCommandFaultsTest, SurvivesEveryDamagedByte) {
  const std::string whole = EncodeUpsert({}, test::SampleShape(), kOrigin);
  std::size_t refused = 0;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const unsigned bit : {0U, 1U, 2U, 7U}) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(static_cast<unsigned char>(damaged[at]) ^ (1U << bit));
      if (!Decode(damaged).ok()) ++refused;
    }
  }
  EXPECT_GT(refused, whole.size() / 4);
}

TEST(NexusCommandFaultsTest, LooksAtNoMoreBytesThanACommandMayHave) {
  EXPECT_THAT(
      std::string(Decode(std::string(schema::kCommandBytesMax + 8, '\0')).status().message()),
      testing::HasSubstr("more than"));
  EXPECT_THAT(std::string(Decode(std::string(schema::kCommandBytesMax, '\0')).status().message()),
              testing::Not(testing::HasSubstr("more than")));
}

}  // namespace
}  // namespace uplink::nexus_command
