#pragma once

#include <optional>
#include <vector>

#include "server/journal/adopt_queue.h"
#include "server/journal/call_size.h"
#include "server/journal/holds.h"
#include "server/journal/writer_context.h"

namespace uplink::journal {

/// The step for robots that change hands: lets go of lost robots, and adopts robots whose holders
/// are over.
///
/// Errors:  any error is the store's. The same robots are tried again, fewer at once after
///          kFailuresToHalve failures. If an answer was lost, the store gives it again.
/// Thread:  confined to the writer.
class Adopting final {
 public:
  /// All outlive it.
  Adopting(const WriterContext& context, Holds& holds);

  /// Empty if no robot changes hands.
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
