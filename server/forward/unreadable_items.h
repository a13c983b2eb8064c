#pragma once

#include <functional>
#include <set>

#include <absl/status/status.h>

#include "server/forward/item.h"
#include "server/forward/probe.h"
#include "server/log/logger.h"
#include "server/log/rate_limited.h"

namespace uplink::forward {

/// Items of the store that cannot be made a command. Each is logged and counted once, until it is
/// good or gone.
///
/// Bound: kUnreadableMax are remembered; further ones are logged and counted each time that they
/// are read.
/// Thread: confined to its owner's.
class UnreadableItems final {
 public:
  /// Both outlive it.
  UnreadableItems(const log::Logger& logger, ForwardProbe& probe);

  void Note(const ItemKey& key, const absl::Status& why);
  /// The item is good, or gone.
  void Forget(const ItemKey& key);
  /// All items were read: forgets those that do not exist.
  void KeepOnly(const std::function<bool(const ItemKey&)>& there);

 private:
  void Show();

  ForwardProbe& probe_;
  log::RateLimited lines_;
  std::set<ItemKey> items_;
};

}  // namespace uplink::forward
