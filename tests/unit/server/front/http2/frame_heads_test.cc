#include "server/front/http2/frame_heads.h"

#include <string>

#include <gtest/gtest.h>

namespace uplink::front {
namespace {

const std::string kPreface = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";

std::string Number(std::uint32_t number) {
  std::string bytes;
  for (const unsigned shift : {24U, 16U, 8U, 0U}) {
    bytes += static_cast<char>((number >> shift) & 0xFFU);
  }
  return bytes;
}

std::string Frame(char type, std::uint32_t stream, const std::string& payload) {
  return Number(static_cast<std::uint32_t>(payload.size())).substr(1) + type + '\0' +
         Number(stream) + payload;
}

std::string Goaway(std::uint32_t last_stream, std::uint32_t code, const std::string& text = {}) {
  return Frame(7, 0, Number(last_stream) + Number(code) + text);
}

/// What nghttp2 gets of these bytes, which come in pieces of `piece` bytes.
std::string Passed(const std::string& bytes, std::size_t piece) {
  FrameHeads heads;
  std::string passed;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    std::string_view left = std::string_view(bytes).substr(at, piece);
    while (!left.empty()) passed += heads.TakePart(left);
  }
  return passed;
}

const std::string kData = Frame(0, 1, std::string(300, 'x'));
const std::string kPing = Frame(6, 0, "pingping");

TEST(FrameHeads, IsZeroInEachGoawayHoweverItsBytesCome) {
  const std::string said = kPreface + Frame(4, 0, "") + kData + Goaway(1, 0) + kPing +
                           Goaway(0x7FFFFFFF, 0, "client closing") + kData;
  const std::string read = kPreface + Frame(4, 0, "") + kData + Goaway(0, 0) + kPing +
                           Goaway(0, 0, "client closing") + kData;
  for (std::size_t piece = 1; piece <= said.size(); ++piece) {
    ASSERT_EQ(Passed(said, piece), read) << piece;
  }
}

TEST(FrameHeads, AllElseIsPassedOnInOnePart) {
  // Content that looks like a GOAWAY is none.
  const std::string said = kPreface + Frame(0, 1, Goaway(5, 0)) + kPing;
  FrameHeads heads;
  std::string_view left = said;
  EXPECT_EQ(heads.TakePart(left), said);
  EXPECT_TRUE(left.empty());
}

TEST(FrameHeads, TheCodeStays) {
  EXPECT_EQ(Passed(kPreface + Goaway(3, 11), 1'000), kPreface + Goaway(0, 11));
}

TEST(FrameHeads, AGoawayThatIsTooShortStaysAsItIs) {
  const std::string said = kPreface + Frame(7, 0, Number(5) + "cod") + kPing;
  EXPECT_EQ(Passed(said, 1'000), said);
}

TEST(FrameHeads, TheLargestFrameHidesNothingBehindIt) {
  std::string payload;
  payload.resize(0xFFFFFF, 'x');
  const std::string large = Frame(0, 1, payload);
  EXPECT_EQ(Passed(kPreface + large + Goaway(9, 0), 16'384), kPreface + large + Goaway(0, 0));
}

TEST(FrameHeadsTest, DataPastTheEndOfTheStreamThatEndedLastIsNoticed) {
  FrameHeads heads;
  const auto take = [&heads](const std::string& bytes) {
    std::string_view left = bytes;
    while (!left.empty()) static_cast<void>(heads.TakePart(left));
    return heads.sent_past_end();
  };
  constexpr char kDataType = 0;
  constexpr char kWindowUpdate = 8;
  EXPECT_FALSE(take(kPreface + Frame(kDataType, 0, "x") + Frame(kDataType, 1, "x")));
  heads.NoteEnd(1);
  heads.NoteEnd(0x1020305);
  EXPECT_FALSE(take(Frame(kDataType, 1, "x"))) << "another one ended later";
  EXPECT_FALSE(take(Frame(kWindowUpdate, 0x1020305, Number(1)))) << "it is no DATA";
  EXPECT_TRUE(take(Frame(kDataType, 0x81020305, "")));
}

}  // namespace
}  // namespace uplink::front
