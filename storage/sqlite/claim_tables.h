#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "schema/model/operator_request.h"
#include "storage/claim.h"
#include "storage/commit_record.h"
#include "storage/decide.h"
#include "storage/identity.h"
#include "storage/robot_hold.h"
#include "storage/samples.h"
#include "storage/sqlite/database.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// What is kept of drones that call: claims, the memory of their samples, and which of their
/// requests to operators are open.
///
/// Errors: those of errors.h. Thread: confined to the thread of its database.
class ClaimTables final {
 public:
  [[nodiscard]] absl::Status Prepare(Database& database);

  /// Which process claimed the drone; nothing if none did.
  [[nodiscard]] absl::StatusOr<std::optional<RobotHold>> ClaimOn(std::string_view ruri);
  [[nodiscard]] absl::Status Claim(const ClaimRequest& request, const RobotHold& claim);
  /// A sample was stored under the claim.
  [[nodiscard]] absl::Status Use(std::string_view ruri, SystemTime at);

  /// Without digests if there is no such row.
  [[nodiscard]] absl::StatusOr<SampleMemory> Samples(std::string_view ruri, std::uint32_t type);
  /// As ClaimResult.samples.
  [[nodiscard]] absl::StatusOr<std::vector<SampleMemory>> AllSamples(std::string_view ruri);

  [[nodiscard]] absl::StatusOr<KnownRobot::RequestIds> OpenRequests(std::string_view ruri);
  /// Closes the one that is open, and deletes closed ones over kClosedRequestsPerRobotMax.
  [[nodiscard]] absl::Status CloseRequest(const CommitRecord& record,
                                          const model::OperatorRequest& request);

 private:
  std::unique_ptr<Statement> claim_on_, claim_, use_, samples_, all_samples_, open_requests_,
      close_request_, trim_requests_;
};

}  // namespace uplink::storage::sqlite
