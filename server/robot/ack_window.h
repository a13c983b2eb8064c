#pragma once

#include <cstddef>
#include <deque>

#include "schema/model/ids.h"

namespace uplink::robot {

/// The numbers of a session that wait for a commit. Confined to its owner's lock.
///
/// Bound: at most the robot's in_flight_uplinks_max waiting numbers.
class AckWindow final {
 public:
  /// Numbers up to `seen` count as seen and settled.
  explicit AckWindow(model::Seq seen = 0) : seen_(seen), through_(seen) {}

  /// Highest number seen.
  [[nodiscard]] model::Seq seen() const { return seen_; }
  /// The highest number seen with no waiting number at or below it. Only grows.
  [[nodiscard]] model::Seq through() const { return through_; }
  /// How many numbers wait.
  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }
  [[nodiscard]] bool Waits(model::Seq seq) const;

  /// Numbers up to `seq` are settled elsewhere and count as seen. Waiting ones stay.
  void Raise(model::Seq seq);
  /// A new number, above all seen, that was settled at once.
  void AddSettled(model::Seq seq);
  /// A new number, above all seen, that waits for its commit.
  void AddWaiting(model::Seq seq);
  /// The commit of the numbers from `first` to `last` is done. False if none of them waited.
  bool Settle(model::Seq first, model::Seq last);

 private:
  struct Waiting {
    model::Seq seq = 0;
    /// The highest number seen below `seq`.
    model::Seq seen_before = 0;
  };
  void Advance();

  std::deque<Waiting> waiting_;
  model::Seq seen_ = 0;
  model::Seq through_ = 0;
};

}  // namespace uplink::robot
