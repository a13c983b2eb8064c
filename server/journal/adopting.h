#pragma once

#include <optional>
#include <vector>

#include "server/journal/adopt_queue.h"
#include "server/journal/call_size.h"
#include "server/journal/holds.h"
#include "server/journal/writer_context.h"

namespace uplink::journal {

/// The step for robots that change hands: lets go of those that were lost, and adopts those whose
/// holders are over.
///
/// Errors:  whatever the store tells is the store's error; the same robots are tried again, after
///          kFailuresToHalve failures fewer at once. An answer that was lost is told again.
/// Thread:  confined to the writer.
class Adopting final {
 public:
  /// All outlive it.
  Adopting(const WriterContext& context, Holds& holds);

  /// Nothing if no robot changes hands.
  [[nodiscard]] std::optional<Step> Advance();

 private:
  void LetGo();
  void LetLeave();
  Step Adopt();

  const WriterContext context_;
  Holds& holds_;
  CallSize size_;
  std::vector<AdoptEntry> adopting_;
};

}  // namespace uplink::journal
