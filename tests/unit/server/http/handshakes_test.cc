#include "server/http/handshakes.h"

#include <gtest/gtest.h>

namespace uplink::http {
namespace {

struct Holder final : HandshakeHolder {
  void CutHandshake() override { cut = true; }
  bool cut = false;
};

TEST(Handshakes, TheOldestGivesWayPastTheirNumber) {
  Handshakes handshakes(2);
  Holder first;
  Holder second;
  Holder third;
  static_cast<void>(handshakes.Begin(first));
  const auto place = handshakes.Begin(second);
  EXPECT_FALSE(first.cut || second.cut);
  static_cast<void>(handshakes.Begin(third));
  EXPECT_TRUE(first.cut);
  EXPECT_FALSE(second.cut || third.cut);
  handshakes.End(place);
  EXPECT_EQ(handshakes.under_way(), 1U);
  Holder fourth;
  static_cast<void>(handshakes.Begin(fourth));
  EXPECT_FALSE(third.cut) << "one has ended";
}

}  // namespace
}  // namespace uplink::http
