#pragma once

#include <optional>
#include <span>
#include <string>

#include <absl/status/statusor.h>

#include "server/journal/holds.h"
#include "server/journal/writer_context.h"
#include "storage/compare.h"

namespace uplink::journal {

/// The step after the store was connected to anew. It may be another one that lacks the last
/// commits (a failover to a standby that lagged). Before any other call, everything that this
/// journal holds is compared with it. If the store lacks commits of a robot that it confirmed, the
/// robot's waiting records are void, and its stream begins anew from what the store has.
///
/// Errors:  of the store; the comparison then begins anew. That is also so if the connection breaks
///          between two pages, since the next page's call fails.
/// Thread:  confined to the writer.
class Comparing final {
 public:
  /// All outlive it.
  Comparing(const WriterContext& context, Holds& holds) : context_(context), holds_(holds) {}

  /// Whether the store was connected to anew. Then put taken entries back to the inbox before Do.
  [[nodiscard]] bool Due();
  /// Compares everything. kFailed if the store failed; empty once done.
  [[nodiscard]] std::optional<Step> Do();

 private:
  absl::StatusOr<Reconnected> CompareAll();
  void Follow(const storage::ToldRobot& told, const storage::FoundRobot& found, Reconnected to);
  /// What the store is connected to now.
  [[nodiscard]] Reconnected ConnectedTo() const;

  const WriterContext context_;
  Holds& holds_;
  /// storage::Store::ServerRun of the server that confirmed what is compared.
  std::string server_run_;
};

}  // namespace uplink::journal
