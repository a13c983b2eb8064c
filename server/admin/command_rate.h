#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "server/admin/asker.h"
#include "server/limits/policies.h"
#include "server/limits/recent_keys.h"
#include "server/limits/token_bucket.h"

namespace uplink::admin {

/// How many commands may ask the store: each takes it for a moment, and robots' messages wait
/// behind it. Commands about robots have a share for each caller; those that admin alone may give
/// have a share of their own, so that no operator holds up a revocation.
///
/// Limits: the policies kCommandsOfCaller, kCommands and kAdminCommands (limits/policies.h); past
///         the callers remembered, the one that commanded least recently is forgotten.
/// Thread: thread-safe.
class CommandRate final {
 public:
  /// Takes one command, by its word of actions.h.
  ///
  /// Errors: kResourceExhausted, which names the limit and for which RetryAfterOf says when.
  [[nodiscard]] absl::Status Take(const Asker& asker, std::string_view action, SteadyTime now);

 private:
  static constexpr std::size_t kCallersMax =
      limits::PolicyOf(limits::PolicyId::kCommandsOfCaller).keys_max;

  std::mutex mutex_;
  limits::RecentKeys<std::string, limits::TokenBucket, kCallersMax> callers_;
  limits::TokenBucket all_;
  limits::TokenBucket admins_;
};

/// When a command may be given again that CommandRate refused, in whole seconds; nothing for any
/// other status.
[[nodiscard]] std::optional<std::chrono::seconds> RetryAfterOf(const absl::Status& status);

}  // namespace uplink::admin
