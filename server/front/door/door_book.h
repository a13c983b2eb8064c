#pragma once

#include <atomic>
#include <cstddef>
#include <string>
#include <string_view>

#include <absl/status/status.h>

#include "server/front/door/evictions.h"
#include "server/front/door/key_table.h"
#include "server/front/door/known_sources.h"
#include "server/front/door/lingers.h"
#include "server/front/door/origin.h"
#include "server/front/door/source_lines.h"
#include "server/transport/probe.h"
#include "server/transport/turned_away.h"

namespace uplink::front {

/// What all threads know about arriving and open connections. Thread-safe.
class DoorBook final {
 public:
  struct Limits {
    /// Connections that have shown a trusted certificate.
    std::size_t connections_max = 0;
    /// Connections without a place that linger, so that their peers learn why.
    std::size_t lingers_max = 0;
  };

  DoorBook(const Limits& limits, transport::RelayProbe& probe, const log::Logger* logger)
      : limits_(limits), probe_(probe), lines_(logger), lingers_(limits.lingers_max) {}

  /// A connection is turned away: counts it by cause, and logs a line that names the source. Not
  /// for a health check.
  void Note(transport::TurnedAway cause, const Origin& origin, SteadyTime now);
  /// The same for a handshake that failed. `detail`: what the line adds to the cause; empty:
  /// nothing.
  void NoteFailedHandshake(transport::TurnedAway cause, std::string_view detail,
                           const Origin& origin, SteadyTime now);
  /// A line alone; `kind` as SourceLines has it.
  void Tell(std::string_view event, std::string_view kind, const std::string& why,
            const Origin& origin, SteadyTime now) {
    lines_.Write(event, kind, why, origin, now);
  }
  /// A request is not a call of the relay: counts it, and logs a line.
  void NoteRequest(const std::string& why, const Origin& origin, SteadyTime now);
  /// Logs a call that we end for its messages. kInternal is gRPC's code for breaking its rules.
  void TellFailure(const absl::Status& status, const Origin& origin, SteadyTime now);
  /// Logs the end of a stream with this status if it was refused, broke a rule of the protocol, or
  /// came through a gateway and was superseded.
  void TellRefusal(const absl::Status& status, const Origin& origin, SteadyTime now);

  /// A connection has shown a trusted certificate; false if there is no place for it.
  [[nodiscard]] bool Enter();
  void Leave();

  /// Connections wait for a handshake, so those under way get less time.
  [[nodiscard]] bool pressed() const { return pressed_.load(std::memory_order_relaxed); }
  [[nodiscard]] const std::atomic<bool>& pressed_flag() const { return pressed_; }
  void SetPressed(bool pressed) { pressed_.store(pressed, std::memory_order_relaxed); }

  [[nodiscard]] KeyTable& keys() { return keys_; }
  [[nodiscard]] Evictions& evictions() { return evictions_; }
  [[nodiscard]] KnownSources& known() { return known_; }
  [[nodiscard]] Lingers& lingers() { return lingers_; }

 private:
  void Note(transport::TurnedAway cause, std::string_view detail, const Origin& origin,
            SteadyTime now);

  const Limits limits_;
  transport::RelayProbe& probe_;
  SourceLines lines_;
  KeyTable keys_;
  Evictions evictions_;
  KnownSources known_;
  Lingers lingers_;
  std::atomic<std::size_t> connections_{0};
  std::atomic<bool> pressed_{false};
};

}  // namespace uplink::front
