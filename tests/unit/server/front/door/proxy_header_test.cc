#include "server/front/door/proxy_header.h"

#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "server/front/door/origin.h"
#include "tests/support/proxy_headers.h"

namespace uplink::front {
namespace {

using testing::kProxyLocal;
using testing::kProxyRelayed;
using testing::kProxySignature;
using testing::kProxyTcp4;
using testing::kProxyTcp6;
using testing::kProxyUnspec;
using testing::ProxyAddresses;
using testing::ProxyHeaderBytes;
using testing::ProxyHeaderFor;
using testing::ProxyTlv;
using Result = ProxyHeader::Result;

/// What a reader makes of the bytes, which get `piece` of them at once, and only what it wants.
struct Read {
  Result result = Result::kMore;
  std::size_t taken = 0;
  Origin origin;
};

Read ReadIn(std::string_view bytes, std::size_t piece) {
  ProxyHeader header;
  Read read;
  while (header.wanted() > 0 && read.taken < bytes.size()) {
    const std::string_view next = bytes.substr(read.taken, std::min(piece, header.wanted()));
    read.taken += next.size();
    header.Take(next);
  }
  read.result = header.result();
  read.origin = OriginOf(header.source());
  return read;
}

/// As ReadIn, and the same in pieces of any size.
Read ReadWhole(std::string_view bytes) {
  Read whole = ReadIn(bytes, bytes.size());
  for (const std::size_t piece : {1U, 2U, 3U, 7U, 16U, 17U}) {
    const Read read = ReadIn(bytes, piece);
    EXPECT_EQ(read.result, whole.result) << piece;
    EXPECT_EQ(read.origin.text, whole.origin.text) << piece;
  }
  return whole;
}

TEST(ProxyHeader, SaysForWhomTheConnectionIs) {
  for (const auto& [header, text, source] :
       {std::tuple{ProxyHeaderFor("203.0.113.7", 5555), "203.0.113.7:5555", "203.0.113.7"},
        std::tuple{ProxyHeaderFor("2001:db8:1:2:3:4:5:6", 65535), "[2001:db8:1:2:3:4:5:6]:65535",
                   "2001:db8:1:2::/64"},
        std::tuple{ProxyHeaderFor("::ffff:203.0.113.7", 5555), "203.0.113.7:5555",
                   "203.0.113.7"}}) {
    const Read read = ReadWhole(header);
    EXPECT_EQ(read.result, Result::kRelayed);
    EXPECT_EQ(read.origin.text, text);
    EXPECT_EQ(read.origin.source.ToText(), source);
  }
}

TEST(ProxyHeader, WantsTheFixedPartAndThenExactlyTheRest) {
  ProxyHeader header;
  EXPECT_EQ(header.wanted(), 16U);
  EXPECT_FALSE(header.begun());
  const std::string bytes = ProxyHeaderFor("203.0.113.7");
  header.Take(std::string_view(bytes).substr(0, 10));
  EXPECT_TRUE(header.begun());
  EXPECT_EQ(header.wanted(), 6U);
  header.Take(std::string_view(bytes).substr(10, 6));
  EXPECT_EQ(header.wanted(), 12U);
  header.Take(std::string_view(bytes).substr(16));
  EXPECT_EQ(header.wanted(), 0U);
}

TEST(ProxyHeader, LeavesWhatFollowsIt) {
  for (const std::string& header :
       {ProxyHeaderFor("203.0.113.7"), ProxyHeaderFor("2001:db8::1"), testing::LocalProxyHeader(),
        ProxyHeaderFor("203.0.113.7", 1, ProxyTlv(4, std::string(300, 'x')))}) {
    EXPECT_EQ(ReadIn(header + "\x16\x03\x01", 1000).taken, header.size());
  }
}

TEST(ProxyHeader, EveryTruncationWantsMore) {
  for (const std::string& header :
       {ProxyHeaderFor("203.0.113.7", 1, ProxyTlv(1, "h2")), ProxyHeaderFor("2001:db8::1")}) {
    for (std::size_t size = 0; size < header.size(); ++size) {
      EXPECT_EQ(ReadWhole(std::string_view(header).substr(0, size)).result, Result::kMore) << size;
    }
  }
}

TEST(ProxyHeader, WhatFollowsTheAddressesIsSkipped) {
  const std::string more = ProxyTlv(1, "h2") + ProxyTlv(0x20, std::string(200, 'c')) +
                           ProxyTlv(0xEA, std::string("\1vpce-0", 7));
  EXPECT_EQ(ReadWhole(ProxyHeaderFor("203.0.113.7", 9, more)).origin.text, "203.0.113.7:9");
  EXPECT_EQ(ReadWhole(ProxyHeaderFor("2001:db8::1", 9, more)).origin.text, "[2001:db8::1]:9");
  // Nothing is read in there, so nothing can be wrong with it.
  EXPECT_EQ(ReadWhole(ProxyHeaderFor("203.0.113.7", 9, "\xFF\xFF")).result, Result::kRelayed);
}

TEST(ProxyHeader, ALoadBalancerMayComeOnItsOwnAccount) {
  EXPECT_EQ(ReadWhole(testing::LocalProxyHeader()).result, Result::kLocal);
  EXPECT_EQ(testing::LocalProxyHeader(), kLocalProxyHeader);
  EXPECT_EQ(ReadWhole(ProxyHeaderBytes(kProxyLocal, kProxyUnspec, ProxyTlv(4, "x"))).result,
            Result::kLocal);
  // Family and addresses count for nothing then.
  const Read read =
      ReadWhole(ProxyHeaderBytes(kProxyLocal, kProxyTcp4, ProxyAddresses("203.0.113.7", 1)));
  EXPECT_EQ(read.result, Result::kLocal);
  EXPECT_EQ(read.origin.source, SourceAddress());
  EXPECT_EQ(ReadWhole(ProxyHeaderBytes(kProxyLocal, 0xFF, {})).result, Result::kLocal);
}

TEST(ProxyHeader, AnAddressMayStayUntold) {
  for (const std::string& rest : {std::string(), std::string("whatever")}) {
    const Read read = ReadWhole(ProxyHeaderBytes(kProxyRelayed, kProxyUnspec, rest));
    EXPECT_EQ(read.result, Result::kUntold);
    EXPECT_EQ(read.origin.source, SourceAddress());
  }
}

TEST(ProxyHeader, TheFirstWrongByteOfTheSignatureEndsIt) {
  for (std::size_t i = 0; i < kProxySignature.size(); ++i) {
    std::string header = ProxyHeaderFor("203.0.113.7");
    header[i] = static_cast<char>(header[i] ^ 1);
    const Read read = ReadIn(header, 1);
    EXPECT_EQ(read.result, Result::kInvalid);
    EXPECT_EQ(read.taken, i + 1);
  }
}

TEST(ProxyHeader, VersionOneAndTlsAreNone) {
  for (const std::string& bytes :
       {std::string("PROXY TCP4 203.0.113.7 127.0.0.1 4711 7443\r\n"),
        std::string("PROXY UNKNOWN\r\n"),
        std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xFC\x03\x03", 11)}) {
    EXPECT_EQ(ReadWhole(bytes).result, Result::kInvalid);
  }
}

TEST(ProxyHeader, EveryOtherVersionAndCommandIsInvalid) {
  const std::string addresses = ProxyAddresses("203.0.113.7", 1);
  for (unsigned byte = 0; byte < 256; ++byte) {
    const auto command = static_cast<std::uint8_t>(byte);
    const Result result = ReadWhole(ProxyHeaderBytes(command, kProxyTcp4, addresses)).result;
    const bool known = command == kProxyLocal || command == kProxyRelayed;
    EXPECT_EQ(result != Result::kInvalid, known) << byte;
  }
}

TEST(ProxyHeader, EveryOtherFamilyIsInvalid) {
  // As many bytes as the addresses of local sockets take.
  const std::string addresses(216, '\1');
  for (unsigned byte = 0; byte < 256; ++byte) {
    const auto family = static_cast<std::uint8_t>(byte);
    const Result result = ReadWhole(ProxyHeaderBytes(kProxyRelayed, family, addresses)).result;
    const bool known = family == kProxyUnspec || family == kProxyTcp4 || family == kProxyTcp6;
    EXPECT_EQ(result != Result::kInvalid, known) << byte;
  }
}

TEST(ProxyHeader, AddressesThatAreShorterThanTheirFamilyAreInvalid) {
  const auto result = [](std::uint8_t family, std::size_t size) {
    return ReadWhole(ProxyHeaderBytes(kProxyRelayed, family, std::string(size, '\1'))).result;
  };
  for (std::size_t size = 0; size < 12; ++size) {
    EXPECT_EQ(result(kProxyTcp4, size), Result::kInvalid) << size;
  }
  EXPECT_EQ(result(kProxyTcp4, 12), Result::kRelayed);
  for (std::size_t size = 0; size < 36; ++size) {
    EXPECT_EQ(result(kProxyTcp6, size), Result::kInvalid) << size;
  }
  EXPECT_EQ(result(kProxyTcp6, 36), Result::kRelayed);
}

TEST(ProxyHeader, ItsLengthIsBounded) {
  for (const std::uint8_t command : {kProxyLocal, kProxyRelayed}) {
    const auto result = [command](std::size_t size) {
      return ReadWhole(ProxyHeaderBytes(command, kProxyUnspec, std::string(size, '\1'))).result;
    };
    EXPECT_NE(result(ProxyHeader::kRestBytesMax), Result::kInvalid);
    EXPECT_EQ(result(ProxyHeader::kRestBytesMax + 1), Result::kInvalid);
    EXPECT_EQ(result(65'535), Result::kInvalid);
  }
}

TEST(ProxyHeader, WhatIsInvalidIsSoBeforeItsRestIsRead) {
  const std::string header = ProxyHeaderBytes(kProxyRelayed, kProxyUnspec, std::string(1000, '\1'));
  EXPECT_EQ(ReadIn(header, 5000).taken, ProxyHeader::kFixedBytes);
}

}  // namespace
}  // namespace uplink::front
