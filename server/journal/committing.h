#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "server/journal/call_size.h"
#include "server/journal/gathered_batch.h"
#include "server/journal/holds.h"
#include "server/journal/writer_context.h"

namespace uplink::journal {

/// The steps of a batch: gather it from the inbox, commit it, report its outcomes.
///
/// Errors:  a failed commit is tried again as it was, since it may have been carried out: the
///          cursor decides. After kFailuresToHalve failures its later half goes back to the inbox.
/// Thread:  confined to the writer.
class Committing final {
 public:
  struct Limits {
    std::size_t records_max = 0;
    std::size_t bytes_max = 0;
    BatchShare robot;
    BatchShare gateway = kGatewayBatchShare;
  };
  /// All of `context`, and `holds`, outlive it. `presence_session` numbers the changes of presence.
  Committing(const WriterContext& context, Holds& holds, const Limits& limits,
             const model::SessionId& presence_session);

  /// A batch was gathered, and is not committed or not reported yet.
  [[nodiscard]] bool HasBatch() const { return !batch_.empty(); }
  /// A batch was committed, and its outcomes are not reported yet.
  [[nodiscard]] bool HasOutcomes() const { return outcomes_.has_value(); }

  /// Gathers a batch from the inbox, unless there is one. True if there is one now.
  [[nodiscard]] bool Gather();
  /// Puts its records, gaps and changes of presence back to the front.
  void PutBack();
  /// Commits the batch, without entries that became void.
  [[nodiscard]] Step Commit();
  /// Reports the outcomes, makes room in the inbox, and wakes the robots' streams.
  void Tell();

 private:
  void DropVoid();
  /// Notes robots whose rows went to quarantine.
  void NoteQuarantined(std::span<const storage::Outcome> outcomes);
  void FinishPresence(std::span<const storage::Outcome> outcomes);

  const WriterContext context_;
  Holds& holds_;
  const Limits limits_;
  CallSize size_;
  GatheredBatch batch_;
  std::optional<std::vector<storage::Outcome>> outcomes_;
};

}  // namespace uplink::journal
