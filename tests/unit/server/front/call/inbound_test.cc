#include "server/front/call/inbound.h"

#include <string>

#include <gtest/gtest.h>

#include "server/front/call/outbound.h"
#include "server/front/http2/limits.h"

namespace uplink::front {
namespace {

constexpr std::size_t kLargest = 200'000;
constexpr KeyDigest kKey{1};

/// The prefix of a message of so many bytes.
std::string PrefixOf(std::size_t bytes) {
  std::string prefix(kPrefixBytes, '\0');
  transport::PutPrefix(bytes, prefix.data());
  return prefix;
}

class InboundTest : public ::testing::Test {
 protected:
  InboundTest() { inbound_.reader().SetMax(kLargest); }
  /// Bytes arrive while the handler waits; by how many the window opens.
  Inbound::WindowBytes Arrive(const std::string& bytes) {
    inbound_.reader().Add(bytes);
    inbound_.reader().Keep();
    return inbound_.NoteUnfinished(true, kKey, SteadyTime{});
  }
  [[nodiscard]] std::int64_t held() const { return probe_.unfinished_bytes.value(); }

  transport::RelayProbe probe_;
  Unfinished unfinished_{{.bytes_max = kLargest, .share_max = kLargest}, probe_};
  Inbound inbound_{unfinished_, {nullptr, 1}};
};

TEST_F(InboundTest, TheWindowOpensByAMessageOnceItIsTaken) {
  const std::string message = PrefixOf(3) + "abc";
  EXPECT_EQ(Arrive(message), 0U);
  EXPECT_EQ(inbound_.Pop(), message.size());
  EXPECT_EQ(held(), 0);
}

TEST_F(InboundTest, TheWindowOpensEarlyForAMessageThatNeedsMoreAndOnceForEachByte) {
  const std::string begin = PrefixOf(kLargest) + std::string(1000, 'a');
  EXPECT_EQ(Arrive(begin), begin.size());
  EXPECT_GT(held(), 0);
  EXPECT_EQ(Arrive(std::string(500, 'b')), 500U);
  const std::string rest(kLargest - 1500, 'c');
  EXPECT_EQ(Arrive(rest), 0U) << "it is whole";
  EXPECT_EQ(held(), 0);
  EXPECT_EQ(inbound_.Pop(), rest.size());
}

TEST_F(InboundTest, ASmallMessageOpensNoWindowEarly) {
  EXPECT_EQ(Arrive(PrefixOf(static_cast<std::size_t>(kStreamWindowBytes) / 2 - kPrefixBytes) + "a"),
            0U);
  EXPECT_GT(held(), 0) << "its memory counts";
}

TEST_F(InboundTest, WhatNobodyAwaitsHoldsNoMemoryOfUnfinishedMessages) {
  Arrive(PrefixOf(1000) + "a");
  EXPECT_GT(held(), 0);
  EXPECT_EQ(inbound_.NoteUnfinished(false, kKey, SteadyTime{}), 0U);
  EXPECT_EQ(held(), 0);
}

TEST_F(InboundTest, WhatIsDroppedOpensTheWindowByWhatDidNotOpenItBefore) {
  const std::string begin = PrefixOf(kLargest) + "a";
  EXPECT_EQ(Arrive(begin), begin.size());
  inbound_.reader().Add("bc");
  EXPECT_EQ(inbound_.Drop(), 2U);
  EXPECT_EQ(inbound_.reader().waiting(), 0U);
}

}  // namespace
}  // namespace uplink::front
