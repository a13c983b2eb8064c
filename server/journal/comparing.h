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
/// journal holds is compared with it. Records that the store confirmed and does not have are void,
/// and the robots' streams begin anew from what it has.
///
/// Errors:  of the store; the comparison then begins anew, also if the connection breaks between
///          two pages: the next page's call fails then.
/// Thread:  confined to the writer.
class Comparing final {
 public:
  /// All outlive it.
  Comparing(const WriterContext& context, Holds& holds) : context_(context), holds_(holds) {}

  /// Whether there is something to compare. Put taken entries back to the inbox before.
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
