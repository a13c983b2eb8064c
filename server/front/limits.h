#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "schema/base/clock.h"

namespace uplink::front {

/// Bytes that a stream may send ahead of what its session has taken: its HTTP/2 window. What a
/// stream that is held back costs.
inline constexpr std::int32_t kStreamWindowBytes = 65'535;
/// Bytes under way on a connection, over all its streams. They are given back as they arrive, so
/// that a stream that is held back never holds up its neighbours.
inline constexpr std::int32_t kConnectionWindowBytes = 1024 * 1024;
/// HTTP/2's own overhead of a header in the size of a list of headers.
inline constexpr std::size_t kHeaderOverheadBytes = 32;
/// Bytes of all headers of a request, counted as HTTP/2 does.
inline constexpr std::uint32_t kHeaderBytesMax = 8 * 1024;
/// A peer whose headers are past this, counted the same, is not one that has overlooked the limit:
/// a few bytes may stand for megabytes of them, each of which costs us time.
inline constexpr std::size_t kHeaderBombBytes = std::size_t{8} * kHeaderBytesMax;
/// Bytes of a path that is told apart from others; longer ones are no method of ours.
inline constexpr std::size_t kPathBytesMax = 256;
/// Streams of one connection of a robot: it needs one, and two at takeover. A gateway's has
/// limits.gateway_streams_max.
inline constexpr std::uint32_t kRobotStreamsMax = 16;
/// Answers to PING and SETTINGS that wait for a peer which does not read, before it is ended.
inline constexpr std::size_t kAnswersWaitingMax = 64;
/// Answers that one record of TLS (16 KiB) can ask for, by SETTINGS without content (9 bytes each).
/// They go out before the next record is read.
inline constexpr std::size_t kAnswersPerRecordMax = std::size_t{16} * 1024 / 9;
/// Given to nghttp2 as a rate where our own bound must come first: more frames per second than can
/// arrive.
inline constexpr std::uint64_t kNoLibraryLimit = std::uint64_t{1} << 32U;

/// What a thread reads at once, over all its connections.
inline constexpr std::size_t kSharedReadBytes = 64 * 1024;
/// Bytes that go out in one call of the system at most; what does not fit waits at its connection.
inline constexpr std::size_t kSendBytesMax = 64 * 1024;
/// Bytes of a connection that the system keeps and has not sent yet: some tenths of a second of a
/// robot's slow network. What is on its way to the peer does not count.
inline constexpr std::size_t kUnsentBytesMax = 32 * 1024;

/// Bytes that wait for a peer that takes nothing, past which it is cut: TLS's own records are sent
/// even while the socket is blocked, so they need this bound.
inline constexpr std::size_t kKeptBytesMax = 4 * kSendBytesMax;

/// A peer that is gone without a word is noticed within these two; robots' networks are bad.
inline constexpr std::chrono::seconds kKeepaliveAfter{25};
inline constexpr std::chrono::seconds kKeepaliveWait{15};
/// How long a handshake may wait for its peer, and how long while others wait for a place.
inline constexpr std::chrono::seconds kHandshakeWait{20};
inline constexpr std::chrono::seconds kHandshakeWaitPressed{5};
/// How long a connection may be without its first stream, and how long while others wait.
inline constexpr std::chrono::seconds kFirstStreamWait{10};
inline constexpr std::chrono::seconds kFirstStreamWaitPressed{3};
/// How often a connection past its pressed wait is checked again.
inline constexpr std::chrono::seconds kLookAgain{1};
/// Connections of one public key: more than one only while an old one is not known to be gone, and
/// a gateway's may spread its robots.
inline constexpr std::size_t kRobotConnectionsMax = 4;
inline constexpr std::size_t kGatewayConnectionsMax = 16;
/// A connection whose streams have all ended is closed after this.
inline constexpr std::chrono::minutes kIdleWait{5};
/// How long we read on after our last word, so that no reset destroys it on its way.
inline constexpr std::chrono::seconds kLingerWait{1};
/// How many reads of kSharedReadBytes we do in that time: as many as a handshake may take
/// (kHandshakeReadsMax). Without a bound a stranger's bytes cost 350 ms of CPU in that second
/// (measured).
inline constexpr std::size_t kLingerReadsMax = 128;
/// A peer that does not take what waits for it, kSendBytesMax at a time, within this is cut:
/// reading a byte now and then keeps its place no longer.
inline constexpr std::chrono::seconds kBlockedWait{40};
/// Further away than this is never: times beyond would not fit the clock's numbers.
inline constexpr std::chrono::hours kFarAway{24 * 365 * 10};
/// Streams of a connection that has reached its age have so long to settle.
inline constexpr std::chrono::seconds kAgeGrace{10};
/// How often what is left of a certificate is looked at: the civil clock may be set, or be vouched
/// for only then.
inline constexpr std::chrono::minutes kExpiryLook{1};
/// A connection ends so long before its certificate does.
inline constexpr std::chrono::minutes kBeforeExpiry{10};
/// Unless so little was left of it when the connection opened.
inline constexpr std::chrono::minutes kNearlyOver{2 * kBeforeExpiry};

/// Bytes of unfinished frames that the streams of all threads may hold together, unless the process
/// may use less memory, or one frame may have more.
inline constexpr std::size_t kUnfinishedBytesMax = std::size_t{256} * 1024 * 1024;

}  // namespace uplink::front
