#pragma once

#include <optional>
#include <span>
#include <string>

#include <absl/status/statusor.h>

#include "server/journal/holds.h"
#include "server/journal/writer_context.h"
#include "storage/compare.h"

namespace uplink::journal {

/// The step after the store was connected to anew: it may be another one, which lacks the last
/// commits (a failover to a standby that lagged). Before anything else is asked of it, all that
/// this journal holds is compared with it. What the store does not have as it told is void, and the
/// robots' streams begin anew from what it has.
///
/// Errors:  of the store; the comparison begins anew then. So it does where the connection breaks
///          between two pages: that is found by the next page's call, which fails.
/// Thread:  confined to the writer.
class Comparing final {
 public:
  /// All outlive it.
  Comparing(const WriterContext& context, Holds& holds) : context_(context), holds_(holds) {}

  /// Whether there is something to compare: what was taken from the inbox goes back first.
  [[nodiscard]] bool Due();
  /// Compares all. kFailed where the store failed; nothing once it is done.
  [[nodiscard]] std::optional<Step> Do();

 private:
  absl::StatusOr<Reconnected> CompareAll();
  void Follow(const storage::ToldRobot& told, const storage::FoundRobot& found, Reconnected to);
  /// To what the store is connected, after it was to something else.
  [[nodiscard]] Reconnected ConnectedTo() const;

  const WriterContext context_;
  Holds& holds_;
  /// storage::Store::ServerRun of the server that told what is compared.
  std::string server_run_;
};

}  // namespace uplink::journal
