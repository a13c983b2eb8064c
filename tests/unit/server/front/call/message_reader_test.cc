#include "server/front/call/message_reader.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::front {
namespace {

using Kind = MessageReader::Next::Kind;
using ::testing::ElementsAre;

constexpr std::uint64_t kBytesMax = 1000;

std::string Prefix(std::uint32_t bytes, char flag = 0) {
  std::string prefix(1, flag);
  for (const unsigned shift : {24U, 16U, 8U, 0U}) {
    prefix += static_cast<char>((bytes >> shift) & 0xFFU);
  }
  return prefix;
}

std::string Framed(const std::string& message) {
  return Prefix(static_cast<std::uint32_t>(message.size())) + message;
}

std::vector<std::string> TakeAll(MessageReader& reader) {
  std::vector<std::string> taken;
  for (auto next = reader.Peek(); next.kind == Kind::kMessage; next = reader.Peek()) {
    taken.emplace_back(next.message);
    reader.Pop();
  }
  return taken;
}

TEST(MessageReader, CutsMessagesOutOfOnePiece) {
  MessageReader reader(kBytesMax);
  const std::string bytes = Framed("one") + Framed("") + Framed("three");
  reader.Add(bytes);
  EXPECT_THAT(TakeAll(reader), ElementsAre("one", "", "three"));
  reader.Keep();
  EXPECT_EQ(reader.waiting(), 0U);
}

TEST(MessageReader, WhereTheBytesAreCutMakesNoDifference) {
  const std::string bytes = Framed("one") + Framed("") + Framed(std::string(300, 'x'));
  for (std::size_t step = 1; step <= bytes.size(); ++step) {
    MessageReader reader(kBytesMax);
    std::vector<std::string> taken;
    for (std::size_t from = 0; from < bytes.size(); from += step) {
      const std::string piece = bytes.substr(from, step);  // gone after Keep
      reader.Add(piece);
      for (std::string& message : TakeAll(reader)) taken.push_back(std::move(message));
      reader.Keep();
    }
    ASSERT_THAT(taken, ElementsAre("one", "", std::string(300, 'x'))) << "pieces of " << step;
    ASSERT_EQ(reader.waiting(), 0U);
  }
}

TEST(MessageReader, KeepsWhatIsNotTaken) {
  MessageReader reader(kBytesMax);
  {
    const std::string bytes = Framed("one") + Framed("two");
    reader.Add(bytes);
    reader.Pop();
    reader.Keep();
  }
  EXPECT_EQ(reader.waiting(), kPrefixBytes + 3);
  const std::string more = Framed("three");
  reader.Add(more);
  EXPECT_THAT(TakeAll(reader), ElementsAre("two", "three"));
}

TEST(MessageReader, AMessageAtTheLimitIsOneAndALongerOneIsNot) {
  MessageReader reader(kBytesMax);
  const std::string at = Prefix(kBytesMax);
  reader.Add(at);
  EXPECT_EQ(reader.Peek().kind, Kind::kNone);
  EXPECT_EQ(reader.unfinished(), kPrefixBytes + kBytesMax);

  MessageReader other(kBytesMax);
  const std::string past = Prefix(kBytesMax + 1);
  other.Add(past);
  EXPECT_EQ(other.Peek().kind, Kind::kTooLarge);
  EXPECT_EQ(other.Peek().bytes, kBytesMax + 1);
  EXPECT_FALSE(other.unfinished());
}

TEST(MessageReader, TheLargestLengthIsReadAsWhatItIs) {
  MessageReader reader(kBytesMax);
  const std::string bytes = Prefix(0xFFFFFFFFU);
  reader.Add(bytes);
  EXPECT_EQ(reader.Peek().kind, Kind::kTooLarge);
  EXPECT_EQ(reader.Peek().bytes, 0xFFFFFFFFU);
}

TEST(MessageReader, AFlagIsNoMessage) {
  for (const char flag : {'\1', '\2', '\xFF'}) {
    MessageReader reader(kBytesMax);
    const std::string bytes = Prefix(0, flag);
    reader.Add(bytes);
    EXPECT_EQ(reader.Peek().kind, Kind::kBadFlag);
  }
}

TEST(MessageReader, APartOfAPrefixIsNotUnfinishedYet) {
  MessageReader reader(kBytesMax);
  const std::string bytes = Prefix(7).substr(0, kPrefixBytes - 1);
  reader.Add(bytes);
  EXPECT_EQ(reader.Peek().kind, Kind::kNone);
  EXPECT_FALSE(reader.unfinished());
  EXPECT_EQ(reader.waiting(), kPrefixBytes - 1);
}

TEST(MessageReader, ALargeMessageDoesNotLeaveItsMemoryToWhatComesBehind) {
  MessageReader reader(1 << 20);
  const std::string large = Framed(std::string(1 << 20, 'x'));
  for (std::size_t from = 0; from < large.size(); from += 10'000) {
    const std::string piece = large.substr(from, 10'000);
    reader.Add(piece);
    reader.Keep();
  }
  const std::string next(1, '\0');
  reader.Add(next);
  reader.Keep();
  reader.Pop();
  EXPECT_EQ(reader.waiting(), 1U);
  EXPECT_LT(reader.held(), 1000U);
}

TEST(MessageReader, ClearForgetsAll) {
  MessageReader reader(kBytesMax);
  const std::string bytes = Framed("one") + Prefix(9);
  reader.Add(bytes);
  reader.Keep();
  reader.Clear();
  EXPECT_EQ(reader.waiting(), 0U);
  EXPECT_EQ(reader.Peek().kind, Kind::kNone);
}

}  // namespace
}  // namespace uplink::front
