#include "tests/bench/fair/misbehaviour.h"

#include <memory>
#include <utility>
#include <vector>

#include "tests/bench/fair/bad_payloads.h"
#include "tests/bench/fair/flood.h"
#include "tests/bench/fair/gateway_flood.h"
#include "tests/bench/fair/reject_storm.h"
#include "tests/bench/fair/takeover_war.h"
#include "tests/bench/load/client.h"

namespace uplink::bench {
namespace {

/// 10 Mbit/s.
constexpr std::size_t kTextBytesPerSecond = 10'000'000 / 8;
/// Shapes that are there at once.
constexpr std::size_t kShapeIds = 32;
/// Of a frame (limits.batch_uplinks_max).
constexpr std::size_t kMalformedAFrame = 250;
constexpr std::size_t kExtrasAFrame = 16;
constexpr std::size_t kGapsAFrame = 64;
constexpr std::size_t kMuteAFrame = 32;
/// Messages of a text for one snapshot of settings: as many bytes of each.
constexpr std::size_t kTextsASnapshot = 31;
constexpr milliseconds kStatesEvery{100};
constexpr std::int64_t kMicrosAMilli = 1000;
/// The largest jump that is no protocol error (relay.proto).
constexpr std::uint64_t kLargestStep = std::uint64_t{1} << 32;
/// A stream that reads nothing is left after this.
constexpr milliseconds kMuteFor{3'000};
/// What a server may say to one that reads nothing: a Welcome and some Rejects.
constexpr std::uint32_t kMuteWindowBytes = 4096;

using Frame = std::vector<BadMessage>;

/// Frames of so many messages that `make` returns for their number.
template <typename Make>
Flood::Style FramesOf(std::size_t messages, Make make) {
  Flood::Style style;
  style.frame = [messages, make = std::move(make), number = std::size_t{0}]() mutable {
    Frame frame;
    for (std::size_t i = 0; i < messages; ++i) frame.push_back({make(number++)});
    return frame;
  };
  return style;
}

/// One message per frame, from a list that is made once.
Flood::Style InTurn(std::vector<std::string> payloads) {
  return FramesOf(1, [payloads = std::move(payloads)](std::size_t number) {
    return payloads[number % payloads.size()];
  });
}

Flood::Style Shapes() {
  std::vector<std::string> payloads;
  for (std::size_t i = 0; i < kShapeIds; ++i) payloads.push_back(LargeShape(i));
  return InTurn(std::move(payloads));
}

Flood::Style Texts() {
  Flood::Style style = InTurn({LongText()});
  style.bytes_per_second = kTextBytesPerSecond;
  return style;
}

Flood::Style Controls() {
  std::vector<std::string> payloads(kTextsASnapshot, ControlText());
  payloads.push_back(ControlSettings());
  Flood::Style style = InTurn(std::move(payloads));
  style.bytes_per_second = kTextBytesPerSecond;
  return style;
}

/// Alternately none good and one good: the message as such is rejected, or most of it dropped.
Flood::Style Extras() {
  return FramesOf(kExtrasAFrame, [none = FaultyExtras(0), one = FaultyExtras(1)](
                                     std::size_t number) { return number % 2 == 0 ? none : one; });
}

Flood::Style Joints(const Clock& clock, const std::string& ruri) {
  Flood::Style style;
  style.pause = kStatesEvery;
  style.frame = [&clock, ruri, generation = std::uint64_t{0}]() mutable {
    const std::int64_t now_us = UnixMs(clock.System()) * kMicrosAMilli;
    return Frame{{RenamedJoints(ruri, now_us, ++generation), BadMessage::Content::kRcan}};
  };
  return style;
}

Flood::Style Gaps() {
  Flood::Style style = FramesOf(kGapsAFrame, Payload);
  // Numbers run to 2^63-1: that is two thousand million jumps of the largest.
  style.step = [large = false]() mutable {
    large = !large;
    return large ? kLargestStep : std::uint64_t{2};
  };
  return style;
}

Flood::Style Mute() {
  Flood::Style style = FramesOf(kMuteAFrame, [](std::size_t number) {
    return number % 2 == 0 ? GoodEvent(number) : Malformed(number);
  });
  style.left_after = kMuteFor;
  return style;
}

std::unique_ptr<Misbehaviour> MakeFlood(BadWorld& world, Flood::Style style) {
  return std::make_unique<Flood>(world, std::move(style));
}

}  // namespace

std::unique_ptr<Misbehaviour> MakeMisbehaviour(Misdeed misdeed, BadWorld& world,
                                               const std::string& ruri) {
  switch (misdeed) {
    case Misdeed::kShapes:
      return MakeFlood(world, Shapes());
    case Misdeed::kTexts:
      return MakeFlood(world, Texts());
    case Misdeed::kControls:
      return MakeFlood(world, Controls());
    case Misdeed::kMalformed:
      return MakeFlood(world, FramesOf(kMalformedAFrame, Malformed));
    case Misdeed::kRejects:
      return std::make_unique<RejectStorm>(world);
    case Misdeed::kTakeover:
      return std::make_unique<TakeoverWar>(world);
    case Misdeed::kExtras:
      return MakeFlood(world, Extras());
    case Misdeed::kJoints:
      return MakeFlood(world, Joints(world.clock, ruri));
    case Misdeed::kGaps:
      return MakeFlood(world, Gaps());
    case Misdeed::kMute:
      world.link.window_bytes = kMuteWindowBytes;
      world.link.window_renewed = false;
      return MakeFlood(world, Mute());
    case Misdeed::kGateway:
      return std::make_unique<GatewayFlood>(world, ruri);
  }
  return nullptr;
}

}  // namespace uplink::bench
