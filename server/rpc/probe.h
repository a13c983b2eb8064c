#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>

#include <absl/status/status.h>

#include "metrics/cells.h"
#include "metrics/exposition.h"
#include "server/rpc/path_methods.h"
#include "server/transport/probe.h"

namespace uplink::rpc {

/// How a call ends. A closed list.
enum class CallOutcome : std::uint8_t {
  kOk,
  /// Because of who calls: UNAUTHENTICATED, PERMISSION_DENIED.
  kDenied,
  /// For an error of the caller, or what it asks for is not there.
  kWrong,
  /// It may be tried again.
  kFailed,
  /// The caller or its connection broke it off.
  kBroken,
};

/// As metric labels.
inline constexpr std::array<std::string_view, 5> kCallOutcomeTexts = {"ok", "denied", "wrong",
                                                                      "failed", "broken"};

/// Of gRPC's code; nothing: there is none.
[[nodiscard]] CallOutcome OutcomeOf(std::optional<absl::StatusCode> code);

/// What is served beside the tables of path_methods.h. Reflection: both its versions.
enum class OtherMethod : std::uint8_t { kWatchRobots, kHealthCheck, kHealthWatch, kReflection };
inline constexpr std::array<std::string_view, 4> kOtherMethodNames = {"WatchRobots", "HealthCheck",
                                                                      "HealthWatch", "Reflection"};

/// One method's calls that ended, by CallOutcome. Thread-safe.
using CallCounts = std::array<metrics::Cell, kCallOutcomeTexts.size()>;

/// What transport::Method::ended does, for these counts, which outlive it.
[[nodiscard]] std::function<void(std::optional<absl::StatusCode>)> CountedIn(CallCounts& counts);

/// What listen.fleet counts. Thread-safe.
struct RpcProbe {
  transport::RelayProbe listener;
  /// In the order of their tables.
  std::array<CallCounts, kViewMethods.size()> view;
  std::array<CallCounts, kAdminMethods.size()> admin;
  std::array<CallCounts, kOtherMethodNames.size()> other;

  [[nodiscard]] CallCounts& Of(OtherMethod method) {
    return other[static_cast<std::size_t>(method)];
  }
};

/// The samples of uplinkd_fleet_rpc_*.
void AddSamples(const RpcProbe& probe, metrics::Exposition& page);

}  // namespace uplink::rpc
