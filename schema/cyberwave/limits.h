#pragma once

#include <cstddef>

/// The bounds of Cyberwave's messages; those of texts, percentages and places are in
/// schema/limits.h.
namespace uplink::cyberwave {

/// Bytes of one message; media may be larger, since they are not read.
inline constexpr std::size_t kMessageBytesMax = std::size_t{64} * 1024;
/// Depth of a message's objects and lists.
inline constexpr std::size_t kDepthMax = 32;
/// Depth of what is shown in the sender's own form. A level costs up to three nested messages of
/// protobuf, whose parsers take 100: inside a page of robots 30 levels would fit, and 28 where that
/// page is JSON (measured: 3.21). The rest is for programs that enclose such a page.
inline constexpr std::size_t kShownDepthMax = 24;
static_assert(kShownDepthMax < kDepthMax);
/// Joints of one message; wanted values of each of its maps.
inline constexpr std::size_t kJointsMax = 256;
/// Values of one metrics message, those of nested objects and lists too.
inline constexpr std::size_t kMetricsMax = 256;
/// Streams of one edge_health.
inline constexpr std::size_t kStreamsMax = 64;
/// Errors of one message.
inline constexpr std::size_t kErrorsMax = 64;
/// Beyond this a position is absurd: metres, in each direction.
inline constexpr double kPositionMMax = 1e9;

}  // namespace uplink::cyberwave
