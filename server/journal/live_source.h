#pragma once

#include <span>
#include <vector>

#include "storage/live_row.h"

namespace uplink::journal {

/// The live states that a journal checkpoints, in rounds. Called on the journal's writer thread,
/// with no lock held.
class LiveSource {
 public:
  virtual ~LiveSource() = default;
  /// What changed of some robots since it was taken last, each robot once: at most
  /// storage::kCheckpointRowsMax rows, and about kCheckpointBytesMax. Nothing: all robots were
  /// looked at, and the next call begins a new round.
  [[nodiscard]] virtual std::vector<storage::LiveRow> TakeChanged() = 0;
  /// The rows were not written: what they hold counts as changed again.
  virtual void PutBack(std::span<const storage::LiveRow> rows) = 0;
};

}  // namespace uplink::journal
