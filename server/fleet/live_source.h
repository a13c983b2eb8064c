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
  /// From now on all robots are looked at again.
  virtual void BeginRound() = 0;
  /// What changed of some robots since it was taken last, each robot once: at most `rows_max` rows,
  /// and about storage::kCheckpointBytesMax. Nothing: the round is through.
  [[nodiscard]] virtual std::vector<storage::LiveRow> TakeChanged(std::size_t rows_max) = 0;
  /// The rows were not written: what they hold counts as changed again.
  virtual void PutBack(std::span<const storage::LiveRow> rows) = 0;
  /// The store does not know yet that the robot is ours, or it is another's: if it may become ours,
  /// what the row holds counts as changed again.
  virtual void PassedOver(const storage::LiveRow& row) = 0;
};

}  // namespace uplink::fleet
