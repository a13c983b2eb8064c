#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "server/limits/policies.h"

namespace uplink::forward {

/// Items that wait for one receiver; past it, it gets a new snapshot. A peer that reads at all is
/// far from it: items are counted once, however often they change.
inline constexpr std::size_t kWaitingMax = 1024;
/// Frames, and bytes, that a receiver takes at once: they leave as one piece, behind which its Acks
/// wait. The last frame may reach beyond.
inline constexpr std::size_t kTakenMax = 16;
inline constexpr std::size_t kTakenBytesMax = 16U * 1024;
/// What one receiver may have waiting, and take at once. A value; none is 0.
struct ReceiverLimits {
  std::size_t waiting_max = kWaitingMax;
  std::size_t taken_max = kTakenMax;
  std::size_t taken_bytes_max = kTakenBytesMax;
};
/// Bytes of what all fleets share. What is over is not forwarded, and that is told.
inline constexpr std::size_t kSharedBytesMax = 256U * 1024 * 1024;
/// What one fleet may have of it: fleets that do not trust each other share a server.
inline constexpr std::size_t kFleetBytesMax = kSharedBytesMax / 4;
/// What one robot may have of it: its 10,000 shapes (storage::BoundOf) with a few points each.
inline constexpr std::size_t kRobotBytesMax = kSharedBytesMax / 16;
/// Items that give way to one of a robot that takes little.
inline constexpr std::size_t kGiveWayMax = 256;
/// Memory that an item takes besides its texts and its frame (measured on the containers).
inline constexpr std::size_t kItemOverheadBytes = 512;
/// Items that are looked up in the store at once: some may be as large as a frame.
inline constexpr std::size_t kLookedUpMax = 256;
/// How often the store is asked for changes, if nothing wakes who asks.
inline constexpr std::chrono::seconds kLookEvery{1};
/// Changes that come sooner after the last look wait for each other: a burst of upserts is one
/// look.
inline constexpr std::chrono::milliseconds kLookAgain{10};
/// They wait so much longer for each stream that the last look woke, up to kLookAgainMax. A write
/// takes 10 to 20 us of CPU, however many changes it holds (docs/reference/performance.md): so what
/// a busy fleet shares takes a third of a core, and not all of several.
inline constexpr std::chrono::microseconds kPauseForOne{50};
inline constexpr std::chrono::milliseconds kLookAgainMax{250};
/// What one robot may make all others of its fleet receive. What is over waits, the latest of each
/// item.
inline constexpr limits::BucketSize kFanOut =
    limits::PolicyOf(limits::PolicyId::kForwardedBytesOfRobot).bucket();
/// What a frame takes on the wire besides its bytes: gRPC's, HTTP/2's, TLS's and TCP's headers.
inline constexpr std::size_t kWireOverheadBytes = 128;
/// Items whose changes may wait for that, of all robots: some 40 MiB. Past it nothing more waits.
inline constexpr std::size_t kPacedItemsMax = 200'000;
/// Of these, looked up in one look.
inline constexpr std::size_t kDueMax = 4 * kLookedUpMax;
/// Where something was left out of a robot's items, they are read again once there may be room, but
/// not more often.
inline constexpr std::chrono::seconds kLookAtLeftOutEvery{60};
/// Items that cannot be read and are remembered, so that their end is noticed and each is told
/// once.
inline constexpr std::size_t kUnreadableMax = 1'000;
/// Receivers that fell behind, of a fleet, that are named in one look.
inline constexpr std::size_t kOverflowsToldMax = 16;
/// Lines per minute about each: items that cannot be read, robots of which items are left out or
/// wait, receivers that fell behind.
inline constexpr std::uint32_t kForwardLinesMax = 20;

}  // namespace uplink::forward
