#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "storage/live_row.h"

namespace uplink::fleet {

/// The live states that a journal checkpoints, in rounds. Called on the journal's writer thread,
/// with no lock held.
class LiveSource {
 public:
  virtual ~LiveSource() = default;
  /// Begins a round, which looks at all robots again.
  virtual void BeginRound() = 0;
  /// Takes what changed since it was last taken, of some robots, each once per round: at most
  /// `rows_max` rows, and about storage::kCheckpointBytesMax. Empty: the round is over.
  [[nodiscard]] virtual std::vector<storage::LiveRow> TakeChanged(std::size_t rows_max) = 0;
  /// The rows were not written: their content counts as changed again.
  virtual void PutBack(std::span<const storage::LiveRow> rows) = 0;
  /// The store skipped the row: it does not know yet that the robot is ours, or it is another's. If
  /// it may become ours, the row's content counts as changed again.
  virtual void PassedOver(const storage::LiveRow& row) = 0;
};

}  // namespace uplink::fleet
