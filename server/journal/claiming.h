#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/journal/ask_queue.h"
#include "server/journal/call_size.h"
#include "server/journal/holds.h"
#include "server/journal/writer_context.h"

namespace uplink::journal {

/// The step that claims drones: calls ClaimDrones for those that wait, and reports the answers to
/// each drone and its robot.
///
/// Errors:  a failed store call is tried again as it was; after kFailuresToHalve failures its later
///          half goes back to the inbox. A claim whose answer was lost is made anew.
/// Limits:  remembers the drones that live and were claimed, one per robot in memory.
/// Thread:  confined to the writer.
class Claiming final {
 public:
  /// All outlive it.
  Claiming(const WriterContext& context, Holds& holds);

  /// Empty if no drone waits to be claimed.
  [[nodiscard]] std::optional<Step> Advance();
  /// The store was connected to anew and may remember less than it confirmed: claimed drones must
  /// claim again.
  void DoubtAll();

 private:
  /// Answers the claims of refused robots, and puts back those of robots that are not judged yet.
  /// True if some were answered.
  bool TakeOutKeptOut();
  void Tell(const ClaimEntry& claim, const storage::ClaimResult& result);

  const WriterContext context_;
  Holds& holds_;
  CallSize size_;
  std::vector<ClaimEntry> claiming_;
  /// Drones that were claimed since the last DoubtAll, by RURI; some may be gone.
  std::map<std::string, std::weak_ptr<robot::CommitClient>> claimed_;
};

}  // namespace uplink::journal
