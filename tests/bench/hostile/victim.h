#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/fair/other_robot.h"

namespace uplink::bench {

/// The honest robots beside an attack, mostly one: of each twenty durable messages per second, each
/// in a batch of its own, evenly spread.
///
/// Errors: one that is cut off comes back and sends again what was not acked; what that cost is in
/// the tally.
/// Thread: confined to one thread, which drives it.
class Victim final {
 public:
  /// Called about every 20 ms; false ends what is going on.
  using OnTurn = std::function<bool()>;

  /// A robot for each identity, of which there is at least one. `loop` and `clock` outlive it.
  Victim(link::Loop& loop, const Clock& clock, link::LinkOptions link,
         std::vector<link::Identity> identities);
  /// Closes the connections and lets them end.
  ~Victim();
  Victim(const Victim&) = delete;
  Victim& operator=(const Victim&) = delete;

  /// Until all are welcomed; false if one is not within `patience`.
  [[nodiscard]] bool Connect(milliseconds patience);
  /// Sends until `on_turn` ends it, and waits for the Acks of what it sent, at most kAckPatience.
  [[nodiscard]] OthersTally Measure(const OnTurn& on_turn);
  /// Durable messages of the first that were acked: the numbers from 1 to this.
  [[nodiscard]] std::uint64_t acked() const { return robots_.front()->settled_seq(); }
  /// Of its session, 16 bytes.
  [[nodiscard]] const std::string& session() const { return robots_.front()->session(); }

  static constexpr milliseconds kAckPatience{5'000};

 private:
  /// One turn of the loop.
  void Turn();
  void Mend();

  OthersWorld world_;
  std::vector<std::unique_ptr<OtherRobot>> robots_;
  std::uint64_t windows_ = 0;
};

}  // namespace uplink::bench
