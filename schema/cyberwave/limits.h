#pragma once

#include <cstddef>

/// The bounds of Cyberwave's messages; those of texts, percentages and places are in
/// schema/limits.h.
namespace uplink::cyberwave {

/// Bytes of one message; media may be larger, since nobody looks into them.
inline constexpr std::size_t kMessageBytesMax = std::size_t{64} * 1024;
/// Depth of a message's objects and lists.
inline constexpr std::size_t kDepthMax = 32;
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
