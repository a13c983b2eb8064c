#pragma once

#include <map>
#include <string>

#include <absl/status/statusor.h>

#include "tools/uplink-fleet/http_client.h"
#include "tools/uplink-fleet/stored_robot.h"
#include "uplink/v1/fleet.pb.h"

namespace uplink::synthetic {

/// Pages that one list is followed for: 10 million rows.
inline constexpr int kPagesMax = 10'000;

/// Reads the server's JSON into the contract's messages, all pages of a list.
///
/// Errors: HttpClient's; kInternal if an answer is not what the contract says.
/// Thread: as HttpClient.
class ServerView final {
 public:
  explicit ServerView(const std::string& address) : http_(address) {}

  [[nodiscard]] absl::StatusOr<v1::ServerStatus> Status();
  /// Every robot of the fleet by RURI, with motion and status.
  [[nodiscard]] absl::StatusOr<std::map<std::string, v1::Robot>> Robots(const std::string& fleet);
  [[nodiscard]] absl::StatusOr<StoredRobot> Stored(const std::string& ruri);

 private:
  HttpClient http_;
};

}  // namespace uplink::synthetic
