#pragma once

#include <map>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "tools/link/http_client.h"
#include "tools/uplink-fleet/compare/compare_forwards.h"
#include "tools/uplink-fleet/compare/stored.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::synthetic {

/// Pages that one list is followed for: 10 million rows.
inline constexpr int kPagesMax = 10'000;

/// Reads the server's JSON into the contract's messages, all pages of a list.
///
/// Errors: link::HttpClient's; kInternal if an answer is not what the contract says.
/// Thread: as link::HttpClient.
class ServerView final {
 public:
  ServerView(const link::HttpServer& server, const Clock& clock) : clock_(clock), http_(server) {}

  [[nodiscard]] absl::StatusOr<v1::ServerStatus> Status();
  /// Every robot of the fleet by RURI, with all parts.
  [[nodiscard]] absl::StatusOr<std::map<std::string, v1::Robot>> Robots(const std::string& fleet);
  /// The shapes and objects that the fleet's robots share.
  [[nodiscard]] absl::StatusOr<SharedItems> Shared(const std::string& fleet);
  /// What the store holds of one robot; of histories what arrived at `from_ms` or later.
  [[nodiscard]] absl::StatusOr<StoredRobot> Stored(const std::string& ruri, std::int64_t from_ms);
  /// One robot as the server writes it; empty: it has never heard of it.
  [[nodiscard]] absl::StatusOr<std::string> RobotText(const std::string& ruri);
  /// What changed in one environment or workflow run, from `from_ms` on.
  [[nodiscard]] absl::StatusOr<std::vector<v1::ScopeUpdate>> ScopeUpdates(const std::string& scope,
                                                                          const std::string& id,
                                                                          std::int64_t from_ms);
  /// What a drone asked operators to do, open or not.
  [[nodiscard]] absl::StatusOr<std::vector<v1::OperatorRequest>> OperatorRequests(
      const std::string& ruri);
  /// Rejected messages from brokers that belong to no robot, from `from_ms` on.
  [[nodiscard]] absl::StatusOr<std::vector<v1::Quarantined>> QuarantineOfNoRobot(
      std::int64_t from_ms);
  /// The server's metrics page.
  [[nodiscard]] absl::StatusOr<std::string> Metrics() { return http_.Get("/metrics"); }

 private:
  /// Between which times the server's clock is now.
  [[nodiscard]] Span Now() const;

  const Clock& clock_;
  link::HttpClient http_;
  /// The server's clock less ours, by the last status: between these two.
  std::int64_t ahead_min_ms_ = 0;
  std::int64_t ahead_max_ms_ = 0;
};

}  // namespace uplink::synthetic
