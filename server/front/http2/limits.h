#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace uplink::front {

/// Bytes that a stream may send ahead of what its session has taken: its HTTP/2 window, and what a
/// stream that is held back costs.
inline constexpr std::int32_t kStreamWindowBytes = 65'535;
/// Bytes under way on a connection, over all its streams. The window opens as they arrive, so a
/// stream that is held back never blocks its neighbours.
inline constexpr std::int32_t kConnectionWindowBytes = 1024 * 1024;
/// HTTP/2's own overhead of a header in the size of a list of headers.
inline constexpr std::size_t kHeaderOverheadBytes = 32;
/// Bytes of all headers of a request, counted as HTTP/2 does.
inline constexpr std::uint32_t kHeaderBytesMax = 8 * 1024;
/// A peer whose headers are past this, counted the same way, is an attack, not a mistake: a few
/// bytes may stand for megabytes of headers, which cost us time.
inline constexpr std::size_t kHeaderBombBytes = std::size_t{8} * kHeaderBytesMax;
/// Streams of one connection of a robot: it needs one, and two at takeover. A gateway's has
/// limits.gateway_streams_max.
inline constexpr std::uint32_t kRobotStreamsMax = 16;
/// Calls that a robot's connection may have open as well, if unary methods are served. It exceeds
/// what their handler lets a drone have in flight (64), so that the handler can refuse the rest
/// with a reason.
inline constexpr std::uint32_t kRobotCallsMax = 80;
/// Calls per second for each stream of a gateway that its connection may have: a drone publishes 26
/// types once a second.
inline constexpr std::uint32_t kCallsPerStream = 26;
/// Answers to PING and SETTINGS that wait for a peer which does not read, before it is ended.
inline constexpr std::size_t kAnswersWaitingMax = 64;
/// Answers that one record of TLS (16 KiB) can ask for, by SETTINGS without content (9 bytes each).
/// They go out before the next record is read.
inline constexpr std::size_t kAnswersPerRecordMax = std::size_t{16} * 1024 / 9;
/// The rate for nghttp2 where our own bound must come first: more frames per second than can
/// arrive.
inline constexpr std::uint64_t kNoLibraryLimit = std::uint64_t{1} << 32U;
/// How long a connection may be without its first stream, and a stream without all its headers.
inline constexpr std::chrono::seconds kFirstStreamWait{10};

}  // namespace uplink::front
