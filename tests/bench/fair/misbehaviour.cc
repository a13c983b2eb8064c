#include "tests/bench/fair/misbehaviour.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "tests/bench/fair/bad_payloads.h"
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
FloodStyle FramesOf(std::size_t messages, Make make) {
  FloodStyle style;
  style.frame = [messages, make = std::move(make), number = std::size_t{0}]() mutable {
    Frame frame;
    for (std::size_t i = 0; i < messages; ++i) frame.push_back({make(number++)});
    return frame;
  };
  return style;
}

/// One message per frame, from a list that is made once.
FloodStyle InTurn(std::vector<std::string> payloads) {
  return FramesOf(1, [payloads = std::move(payloads)](std::size_t number) {
    return payloads[number % payloads.size()];
  });
}

FloodStyle Shapes() {
  std::vector<std::string> payloads;
  for (std::size_t i = 0; i < kShapeIds; ++i) payloads.push_back(LargeShape(i));
  return InTurn(std::move(payloads));
}

FloodStyle Texts() {
  FloodStyle style = InTurn({LongText()});
  style.bytes_per_second = kTextBytesPerSecond;
  return style;
}

FloodStyle Controls() {
  std::vector<std::string> payloads(kTextsASnapshot, ControlText());
  payloads.push_back(ControlSettings());
  FloodStyle style = InTurn(std::move(payloads));
  style.bytes_per_second = kTextBytesPerSecond;
  return style;
}

FloodStyle MalformedOnes() { return FramesOf(kMalformedAFrame, Malformed); }

/// Alternately none good and one good: the message as such is rejected, or most of it dropped.
FloodStyle Extras() {
  return FramesOf(kExtrasAFrame, [none = FaultyExtras(0), one = FaultyExtras(1)](
                                     std::size_t number) { return number % 2 == 0 ? none : one; });
}

FloodStyle Joints(const Clock& clock, const std::string& ruri) {
  FloodStyle style;
  style.pause = kStatesEvery;
  style.frame = [&clock, ruri, generation = std::uint64_t{0}]() mutable {
    const std::int64_t now_us = UnixMs(clock.System()) * kMicrosAMilli;
    return Frame{{RenamedJoints(ruri, now_us, ++generation), BadMessage::Content::kRcan}};
  };
  return style;
}

FloodStyle Gaps() {
  FloodStyle style = FramesOf(kGapsAFrame, Payload);
  // Numbers run to 2^63-1: that is two thousand million jumps of the largest.
  style.step = [large = false]() mutable {
    large = !large;
    return large ? kLargestStep : std::uint64_t{2};
  };
  return style;
}

FloodStyle Mute() {
  FloodStyle style = FramesOf(kMuteAFrame, [](std::size_t number) {
    return number % 2 == 0 ? GoodEvent(number) : Malformed(number);
  });
  style.left_after = kMuteFor;
  return style;
}

/// A flood that needs nothing of the robot.
template <FloodStyle (*kStyle)()>
std::unique_ptr<Misbehaviour> Flooding(BadWorld& world, const std::string& /*ruri*/) {
  return MakeFlood(world, kStyle());
}

std::unique_ptr<Misbehaviour> FloodOfJoints(BadWorld& world, const std::string& ruri) {
  return MakeFlood(world, Joints(world.clock, ruri));
}

std::unique_ptr<Misbehaviour> FloodOfOneMute(BadWorld& world, const std::string& /*ruri*/) {
  world.link.window_bytes = kMuteWindowBytes;
  world.link.window_renewed = false;
  return MakeFlood(world, Mute());
}

constexpr std::array kMisdeeds = std::to_array<Misdeed>({
    {"shapes", "shapes of 256 KiB, as fast as they are read", Flooding<Shapes>},
    {"texts", "10 Mbit/s of messages for people", Flooding<Texts>},
    {.name = "controls",
     .about = "10 Mbit/s of control characters in messages and settings",
     .make = Flooding<Controls>,
     .page_looked_at = true},
    {"malformed", "malformed payloads, as fast as they are read", Flooding<MalformedOnes>},
    {"rejects", "reconnects without a pause, thousands of Rejects unconfirmed", MakeRejectStorm},
    {"takeover", "two connections that take over from each other without a pause", MakeTakeoverWar},
    {"extras", "256 faulty readings per extras message, as fast as they are read",
     Flooding<Extras>},
    {.name = "joints",
     .about = "an RCAN state of 256 new joints every 100 ms, while robots are scraped",
     .make = FloodOfJoints,
     .robots_scraped = true},
    {"gaps", "every number skips some, every other one 2^32", Flooding<Gaps>},
    {"mute", "malformed payloads and events, and no Ack or Reject is read", FloodOfOneMute},
    {.name = "gateway",
     .about = "50 streams of events through one gateway, as fast as they are read",
     .make = MakeGatewayFlood,
     .by_gateway = true},
});

}  // namespace

std::span<const Misdeed> Misdeeds() { return kMisdeeds; }

const Misdeed* MisdeedOf(std::string_view name) {
  const auto* const found = std::ranges::find(kMisdeeds, name, &Misdeed::name);
  return found == kMisdeeds.end() ? nullptr : found;
}

}  // namespace uplink::bench
