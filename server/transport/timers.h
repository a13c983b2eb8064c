#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <utility>

#include "schema/base/clock.h"

namespace uplink::transport {

/// Deadlines are rounded up to this, so that thousands of streams with timers of a second wake a
/// queue at most a hundred times per second.
inline constexpr milliseconds kTimerTick{10};

/// When the streams of a queue want to be called: at most one entry per stream. An entry that turns
/// out too early is harmless, since the stream is asked again. Confined to the queue's thread.
class Timers final {
 public:
  /// A stream's own entry; the stream keeps it, so that the usual case looks nothing up.
  using Slot = std::optional<SteadyTime>;

  /// The stream wants to be called at `deadline`, but never before the tick after `now`. A stream
  /// that has an earlier entry keeps that.
  void Want(std::uint64_t stream, Slot& slot, SteadyTime deadline, SteadyTime now);
  void Forget(std::uint64_t stream, Slot& slot);

  /// The earliest entry.
  [[nodiscard]] std::optional<SteadyTime> next() const;
  /// Takes out one stream whose entry is due; the caller clears its slot.
  [[nodiscard]] std::optional<std::uint64_t> PopDue(SteadyTime now);
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

 private:
  std::set<std::pair<SteadyTime, std::uint64_t>> entries_;
};

}  // namespace uplink::transport
