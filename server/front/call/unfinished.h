#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "schema/base/clock.h"
#include "server/front/door/key_table.h"
#include "server/loop/wake.h"
#include "server/transport/probe.h"

namespace uplink::front {

/// Bytes of unfinished frames that the streams of all threads may hold together, unless the process
/// may use less memory, or one frame may be larger.
inline constexpr std::size_t kUnfinishedBytesMax = std::size_t{256} * 1024 * 1024;

/// The memory of incomplete messages, over all calls of all threads. Past the bound one call ends,
/// so that announcing much and sending little costs the sender's own calls.
///
/// Limits: one entry per call, which the call removes.
/// Thread: thread-safe.
class Unfinished final {
 public:
  struct Limits {
    /// Bytes of all together.
    std::size_t bytes_max = 0;
    /// A certificate's key with more than this loses a call before all others.
    std::size_t share_max = 0;
  };

  Unfinished(const Limits& limits, transport::RelayProbe& probe) : limits_(limits), probe_(probe) {}
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

  /// Notes that `bytes` of the call's message of this number are kept; 0: none is incomplete. A new
  /// number is a message that begins now. With too many bytes in all, wakes the call that must end:
  /// the slowest, whose message began first, of the key with the most if that exceeds its share,
  /// otherwise of all.
  void Set(const loop::StreamRef& call, const KeyDigest& key, std::uint64_t message,
           std::size_t bytes, SteadyTime now);
  /// Whether this call, which was woken, must end.
  [[nodiscard]] bool MustEnd(const loop::StreamRef& call) const;

 private:
  /// Names a call among all threads'.
  using CallId = std::pair<loop::WakeInbox*, std::uint64_t>;
  struct Entry {
    KeyDigest key{};
    SteadyTime began;
    std::uint64_t message = 0;
    std::size_t bytes = 0;
  };
  /// The calls of one key, the slowest first.
  struct Holder {
    std::size_t bytes = 0;
    std::set<std::pair<SteadyTime, CallId>> calls;
  };

  // Under the lock.
  void Note(const CallId& call, const KeyDigest& key, std::uint64_t message, std::size_t bytes,
            SteadyTime now);
  void Remove(const CallId& call);
  [[nodiscard]] std::optional<CallId> Choose() const;
  [[nodiscard]] bool over() const { return bytes_ > limits_.bytes_max; }

  const Limits limits_;
  transport::RelayProbe& probe_;
  mutable std::mutex mutex_;
  std::size_t bytes_ = 0;
  std::map<CallId, Entry> entries_;
  std::map<KeyDigest, Holder> holders_;
  /// The call that was woken to end, and has not ended yet.
  std::optional<CallId> chosen_;
};

/// The limits if the transport may use `memory_bytes_max` (0: unbounded) and a message has at most
/// `frame_bytes_max`: a single message always fits, and is within its key's share.
[[nodiscard]] Unfinished::Limits UnfinishedLimitsFor(std::size_t memory_bytes_max,
                                                     std::size_t frame_bytes_max);

}  // namespace uplink::front
