#include "server/http/handshakes.h"

#include <array>

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
  static_cast<void>(handshakes.Begin(first, {}));
  const auto place = handshakes.Begin(second, {});
  EXPECT_FALSE(first.cut || second.cut);
  static_cast<void>(handshakes.Begin(third, {}));
  EXPECT_TRUE(first.cut);
  EXPECT_FALSE(second.cut || third.cut);
  handshakes.End(place);
  EXPECT_EQ(handshakes.under_way(), 1U);
  Holder fourth;
  static_cast<void>(handshakes.Begin(fourth, {}));
  EXPECT_FALSE(third.cut) << "one has ended";
}

TEST(Handshakes, TheSourceThatHasMostGivesWay) {
  Handshakes handshakes(4);
  Holder slow;
  std::array<Holder, 3> busy;
  static_cast<void>(handshakes.Begin(slow, {1}));
  for (Holder& holder : busy) static_cast<void>(handshakes.Begin(holder, {2}));
  Holder further;
  static_cast<void>(handshakes.Begin(further, {3}));
  EXPECT_FALSE(slow.cut) << "it is older, and alone";
  EXPECT_TRUE(busy[0].cut);
  EXPECT_FALSE(busy[1].cut || busy[2].cut);
}

}  // namespace
}  // namespace uplink::http
