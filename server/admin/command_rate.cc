#include "server/admin/command_rate.h"

#include <array>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

#include <absl/strings/cord.h>
#include <fmt/core.h>

#include "server/admin/actions.h"
#include "server/admin/audit_rows.h"

namespace uplink::admin {
namespace {

using limits::Policy;
using limits::PolicyId;
using limits::PolicyOf;
using limits::TokenBucket;

/// Of the status's payload that holds the seconds.
constexpr std::string_view kRetryAfter = "uplinkd/retry-after";

absl::Status Over(const Policy& policy, SteadyTime::duration wait) {
  const auto seconds = std::chrono::ceil<std::chrono::seconds>(wait).count();
  absl::Status status = absl::ResourceExhaustedError(
      fmt::format("{} may give {} {} per second, {} at once", policy.whose, policy.most, policy.of,
                  policy.at_once));
  status.SetPayload({kRetryAfter.data(), kRetryAfter.size()}, absl::Cord(std::to_string(seconds)));
  return status;
}

}  // namespace

absl::Status CommandRate::Take(const Asker& asker, std::string_view action, SteadyTime now) {
  struct Share {
    TokenBucket* bucket;
    PolicyId policy;
  };
  const std::lock_guard lock(mutex_);
  std::array<Share, 2> shares{{{&admins_, PolicyId::kAdminCommands}, {}}};
  std::size_t count = 1;
  if (GivenByOf(action) != GivenBy::kAdmins) {
    TokenBucket& own = callers_.Touch(fmt::format("{} {}", ToText(asker.proof), asker.caller.name));
    shares = {{{&own, PolicyId::kCommandsOfCaller}, {&all_, PolicyId::kCommands}}};
    count = 2;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Policy& policy = PolicyOf(shares[i].policy);
    const SteadyTime passes_at = shares[i].bucket->PassesAt(1, policy.bucket(), now);
    if (passes_at > now) return Over(policy, passes_at - now);
  }
  for (std::size_t i = 0; i < count; ++i) {
    shares[i].bucket->Take(1, PolicyOf(shares[i].policy).bucket(), now);
  }
  return absl::OkStatus();
}

std::optional<std::chrono::seconds> RetryAfterOf(const absl::Status& status) {
  const auto payload = status.GetPayload({kRetryAfter.data(), kRetryAfter.size()});
  if (!payload) return std::nullopt;
  const std::string text(*payload);
  std::int64_t seconds = 0;
  std::from_chars(text.data(), text.data() + text.size(), seconds);
  return std::chrono::seconds(seconds);
}

}  // namespace uplink::admin
