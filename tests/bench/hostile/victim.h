#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "tests/bench/fair/other_robot.h"

namespace uplink::bench {

/// The honest robot beside an attack: twenty durable messages per second, each in a batch of its
/// own, evenly spread.
///
/// Errors: one that is cut off comes back and sends again what was not acked; what that cost is in
/// the tally.
/// Thread: confined to one thread, which drives it.
class Victim final {
 public:
  /// Called about every 20 ms; false ends what is going on.
  using OnTurn = std::function<bool()>;

  /// `loop` and `clock` outlive it.
  Victim(link::Loop& loop, const Clock& clock, link::LinkOptions link, link::Identity identity);
  /// Closes the connection and lets it end.
  ~Victim();
  Victim(const Victim&) = delete;
  Victim& operator=(const Victim&) = delete;

  /// Until it is welcomed; false if it is not within `patience`.
  [[nodiscard]] bool Connect(milliseconds patience);
  /// Sends until `on_turn` ends it, and waits for the Acks of what it sent, at most kAckPatience.
  [[nodiscard]] OthersTally Measure(const OnTurn& on_turn);
  /// Durable messages that were acked: the numbers from 1 to this.
  [[nodiscard]] std::uint64_t acked() const { return robot_->settled_seq(); }
  /// Of its session, 16 bytes.
  [[nodiscard]] const std::string& session() const { return robot_->session(); }

  static constexpr milliseconds kAckPatience{5'000};

 private:
  /// One turn of the loop.
  void Turn();

  OthersWorld world_;
  std::unique_ptr<OtherRobot> robot_;
  std::uint64_t windows_ = 0;
};

}  // namespace uplink::bench
