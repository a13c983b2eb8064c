// What of a call is to go out, in pieces of any size.
#include "server/front/call/outbound.h"

#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace uplink::front {
namespace {

using namespace std::string_literals;

SharedMessage Shared(std::string_view text) { return std::make_shared<const std::string>(text); }

/// All that waits, taken so many bytes at a time.
std::string TakeAll(Outbound& out, std::size_t at_once) {
  std::string all;
  std::string piece(at_once, '?');
  while (!out.empty()) {
    const std::size_t bytes = out.Take(piece.data(), piece.size());
    if (bytes == 0) return all + " and no more";
    all.append(piece, 0, bytes);
  }
  return all;
}

TEST(OutboundTest, APrefixSaysHowLongTheMessageIs) {
  std::string prefix(kPrefixBytes, '?');
  transport::PutPrefix(0x01020304, prefix.data());
  EXPECT_EQ(prefix, "\0\x01\x02\x03\x04"s);
}

TEST(OutboundTest, AMessageOfItsOwnGoesAsItIs) {
  for (const std::size_t at_once : {1U, 3U, 100U}) {
    Outbound out;
    EXPECT_TRUE(out.empty());
    out.Set("with prefix"s);
    EXPECT_FALSE(out.begun());
    EXPECT_EQ(TakeAll(out, at_once), "with prefix");
    EXPECT_TRUE(out.empty());
  }
}

TEST(OutboundTest, SharedMessagesGoBehindTheirPrefixesWhereverTheyAreCut) {
  const std::string expected = "\0\0\0\0\3one\0\0\0\0\0\0\0\0\0\3two"s;
  for (std::size_t at_once = 1; at_once <= expected.size() + 1; ++at_once) {
    Outbound out;
    out.Set({Shared("one"), Shared(""), Shared("two")});
    EXPECT_EQ(TakeAll(out, at_once), expected) << at_once;
  }
}

TEST(OutboundTest, ItHoldsWhatIsSharedOnceAndNoLongerThanItNeeds) {
  const SharedMessage large = Shared(std::string(100'000, 'x'));
  const SharedMessage small = Shared("y");
  Outbound first;
  Outbound second;
  first.Set({small, large});
  second.Set({large});
  EXPECT_EQ(large.use_count(), 3) << "nothing was copied";
  std::string piece(kPrefixBytes + 1, '?');
  EXPECT_EQ(first.Take(piece.data(), piece.size()), piece.size());
  EXPECT_EQ(small.use_count(), 1);
  EXPECT_TRUE(first.begun());
  static_cast<void>(TakeAll(first, 50'000));
  second.Clear();
  EXPECT_EQ(large.use_count(), 1);
}

TEST(OutboundTest, WhatIsSetLastBeginsAnew) {
  Outbound out;
  out.Set({Shared("one")});
  std::string piece(kPrefixBytes + 3, '?');
  EXPECT_EQ(out.Take(piece.data(), 2), 2U);
  EXPECT_TRUE(out.begun());
  out.Clear();
  EXPECT_TRUE(out.empty());
  out.Set("next"s);
  EXPECT_FALSE(out.begun());
  EXPECT_EQ(TakeAll(out, 3), "next");
}

}  // namespace
}  // namespace uplink::front
