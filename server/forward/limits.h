#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "server/limits/policies.h"

namespace uplink::forward {

/// Items that may wait for one receiver; past it, the receiver gets a new snapshot. A peer that
/// reads at all is far below it, since items count once, however often they change.
inline constexpr std::size_t kWaitingMax = 1024;
/// Frames, and bytes, that a receiver takes at once. They leave as one piece, and its Acks wait
/// behind them. The last frame may exceed the bytes.
inline constexpr std::size_t kTakenMax = 16;
inline constexpr std::size_t kTakenBytesMax = 16U * 1024;
/// What one receiver may have waiting, and take at once. A value; none is 0.
struct ReceiverLimits {
  std::size_t waiting_max = kWaitingMax;
  std::size_t taken_max = kTakenMax;
  std::size_t taken_bytes_max = kTakenBytesMax;
};
/// Bytes of the shared items of all fleets. Items past it are not forwarded, and that is shown.
inline constexpr std::size_t kSharedBytesMax = 256U * 1024 * 1024;
/// One fleet's share of these bytes: fleets that do not trust each other may use one server.
inline constexpr std::size_t kFleetBytesMax = kSharedBytesMax / 4;
/// One robot's share of these bytes: enough for its 10,000 shapes (storage::BoundOf), with a few
/// points each.
inline constexpr std::size_t kRobotBytesMax = kSharedBytesMax / 16;
/// How many items at most give way to one item of a robot that takes little.
inline constexpr std::size_t kGiveWayMax = 256;
/// Memory of an item beside its texts and its frame (measured on the containers).
inline constexpr std::size_t kItemOverheadBytes = 512;
/// Items that are looked up in the store at once: some may be as large as a frame.
inline constexpr std::size_t kLookedUpMax = 256;
/// How often the store is asked for changes without a wake-up.
inline constexpr std::chrono::seconds kLookEvery{1};
/// Changes within this time after a look wait for each other: a burst of upserts is one look.
inline constexpr std::chrono::milliseconds kLookAgain{10};
/// They wait this long for each stream that the last look woke, at most kLookAgainMax. A write
/// takes 10 to 20 us of CPU, however many changes it holds (docs/reference/performance.md). So a
/// busy fleet's sharing takes a third of a core, not all of several.
inline constexpr std::chrono::microseconds kPauseForOne{50};
inline constexpr std::chrono::milliseconds kLookAgainMax{250};
/// Bytes that one robot may make all others of its fleet receive. Past it changes wait, the latest
/// of each item.
inline constexpr limits::BucketSize kFanOut =
    limits::PolicyOf(limits::PolicyId::kForwardedBytesOfRobot).bucket();
/// Overhead of a frame on the wire: gRPC's, HTTP/2's, TLS's and TCP's headers.
inline constexpr std::size_t kWireOverheadBytes = 128;
/// Items, of all robots, that may wait for that: some 40 MiB. Past it, changes go out unpaced.
inline constexpr std::size_t kPacedItemsMax = 200'000;
/// How many waiting items one look looks up.
inline constexpr std::size_t kDueMax = 4 * kLookedUpMax;
/// After items of a robot were left out, its items are read again once there may be room, but not
/// more often than this.
inline constexpr std::chrono::seconds kLookAtLeftOutEvery{60};
/// Unreadable items that are remembered, so that each is logged once, and its end noticed.
inline constexpr std::size_t kUnreadableMax = 1'000;
/// Receivers of a fleet that fell behind and are named in one look.
inline constexpr std::size_t kOverflowsToldMax = 16;
/// Lines per minute about each: items that cannot be read, robots whose items are left out, robots
/// whose items wait, receivers that fell behind.
inline constexpr std::uint32_t kForwardLinesMax = 20;

}  // namespace uplink::forward
