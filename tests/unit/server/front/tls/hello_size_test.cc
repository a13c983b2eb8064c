#include "server/front/tls/hello_size.h"

#include <string>

#include <gtest/gtest.h>

namespace uplink::front {
namespace {

using namespace std::string_literals;  // NOLINT(google-build-using-namespace): bytes with zeros

/// A record with this content; of the handshake, if no other type is named.
std::string Record(const std::string& content, char type = '\x16') {
  return type + "\x03\x01"s + static_cast<char>(content.size() >> 8U) +
         static_cast<char>(content.size()) + content;
}

/// A whole ClientHello of 256 bytes.
std::string Hello() { return Record("\x01\x00\x01\x00"s + std::string(256, 'x')); }
/// The head of one of 131,396 bytes.
std::string LargeHead() { return Record("\x01\x02\x01\x44"); }
constexpr std::size_t kLarge = 131'396;

std::size_t SizeOf(const std::string& bytes) {
  HelloSize at_once;
  at_once.Take(bytes);
  HelloSize bytewise;
  for (const char byte : bytes) bytewise.Take(std::string(1, byte));
  EXPECT_EQ(at_once.size(), bytewise.size());
  return at_once.size();
}

TEST(HelloSize, IsWhatTheMessageSays) {
  EXPECT_EQ(SizeOf(Hello()), 256U);
  EXPECT_EQ(SizeOf(LargeHead()), kLarge);
}

TEST(HelloSize, IsUnknownBeforeItWasSaid) {
  for (std::size_t size = 0; size < 9; ++size) {
    EXPECT_EQ(SizeOf(LargeHead().substr(0, size)), 0U) << size;
  }
}

TEST(HelloSize, MayBeSaidInPieces) {
  EXPECT_EQ(SizeOf(Record("\x01") + Record("\x02\x01") + Record("\x44")), kLarge);
}

TEST(HelloSize, RecordsThatArePassedOverHideNothing) {
  EXPECT_EQ(SizeOf(Record("") + LargeHead()), kLarge);
  EXPECT_EQ(SizeOf(Record("\x01\x00"s, '\x15') + LargeHead()), kLarge) << "an alert";
}

TEST(HelloSize, TheSecondOneCounts) {
  EXPECT_EQ(SizeOf(Hello() + LargeHead()), kLarge);
  EXPECT_EQ(SizeOf(Hello() + Record("\x01", '\x14') + LargeHead()), kLarge);
  EXPECT_EQ(SizeOf(Hello() + Record("early", '\x17') + LargeHead()), kLarge);
  EXPECT_EQ(SizeOf(LargeHead() + Record(std::string(kLarge / 8, 'x'))), kLarge);
}

TEST(HelloSize, BehindAnotherMessageNothingIsRead) {
  // TLS 1.2: a certificate, and what is encrypted after it.
  const std::string certificate = Record("\x0B\x00\x00\x01x"s);
  EXPECT_EQ(SizeOf(Hello() + certificate + Record("\x01", '\x14') + LargeHead()), 256U);
}

TEST(HelloSize, OtherBytesHaveNone) {
  EXPECT_EQ(SizeOf("GET / HTTP/1.1\r\nHost: x\r\n\r\n" + LargeHead()), 0U);
  EXPECT_EQ(SizeOf("\x80\x2E\x01\x03\x01"s + LargeHead()), 0U);
}

}  // namespace
}  // namespace uplink::front
