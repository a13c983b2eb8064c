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

/// The step that claims drones: ClaimDrones for those that wait, and the telling of its answers, to
/// the drone and to its robot.
///
/// Errors:  a store call that failed is tried again with what it held; after kFailuresToHalve of
///          them its later half goes back to the inbox. A claim that was lost with its answer is
///          made anew.
/// Limits:  remembers the drones that live and were claimed, one per robot in memory.
/// Thread:  confined to the writer.
class Claiming final {
 public:
  /// All outlive it.
  Claiming(const WriterContext& context, Holds& holds);

  /// Nothing if no drone is to be claimed.
  [[nodiscard]] std::optional<Step> Advance();
  /// The store was connected to anew and may remember less than it told: drones that were claimed
  /// ask for that again.
  void DoubtAll();

 private:
  void Tell(const ClaimEntry& claim, const storage::ClaimResult& result);

  const WriterContext context_;
  Holds& holds_;
  CallSize size_;
  std::vector<ClaimEntry> claiming_;
  /// By RURI, those that were claimed since the last DoubtAll; some may be gone.
  std::map<std::string, std::weak_ptr<robot::CommitClient>> claimed_;
};

}  // namespace uplink::journal
