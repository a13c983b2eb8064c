#pragma once

#include <functional>
#include <vector>

#include <absl/status/status.h>

#include "server/journal/went_back.h"
#include "server/log/logger.h"
#include "storage/store.h"
#include "storage/store_facts.h"

namespace uplink::store {

/// Logs each change of the store's health once: when it begins to fail, when it works again, and
/// other facts that deserve a line. Confined to one thread at a time.
class HealthLog final {
 public:
  /// The last result of each kind of work on the store, from its journals.
  struct Sources {
    std::function<storage::StoreFacts()> facts;
    std::function<absl::Status()> retention;
    std::function<absl::Status()> checkpoints;
    std::function<absl::Status()> store;
    /// By shard, the robots for which the store was found to have gone back since the last call.
    std::function<std::vector<journal::WentBack>()> went_back = [] {
      return std::vector<journal::WentBack>();
    };
  };
  HealthLog(Sources sources, const log::Logger& logger);

  /// Logs facts of the store's connection: at the start, before anything else is asked of it.
  void LookAtFacts();
  /// Looks at everything.
  void Look();

 private:
  /// Something that fails and works again, with the event of each.
  struct Condition {
    const char* fails;
    const char* works_again;
    bool works = true;
  };
  void LookAtWentBack() const;
  void LookAtSnapshot(const storage::StoreFacts& facts);
  void LogChange(Condition& condition, const absl::Status& status) const;

  const Sources sources_;
  const log::Logger& logger_;
  Condition retention_{"retention_fails", "retention_works_again"};
  Condition checkpoints_{"checkpoint_fails", "checkpoint_works_again"};
  Condition store_{"store_fails", "store_works_again"};
  bool said_unsafe_ = false;
  bool said_clock_ = false;
  bool said_snapshot_ = false;
};

}  // namespace uplink::store
