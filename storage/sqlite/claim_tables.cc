#include "storage/sqlite/claim_tables.h"

#include <string>
#include <utility>

#include "storage/bounds.h"
#include "storage/read_row.h"

namespace uplink::storage::sqlite {

absl::Status ClaimTables::Prepare(Database& database) {
  Preparer prepare(database);
  prepare.Into(claim_on_, "SELECT owner, epoch FROM drone_claims WHERE ruri = ?");
  prepare.Into(claim_,
               "INSERT INTO drone_claims (ruri, owner, epoch, last_used) VALUES (?, ?, ?, ?)"
               " ON CONFLICT (ruri) DO UPDATE SET owner = excluded.owner, epoch = excluded.epoch,"
               " last_used = max(last_used, excluded.last_used)");
  prepare.Into(use_, "UPDATE drone_claims SET last_used = max(last_used, ?2) WHERE ruri = ?1");
  prepare.Into(samples_, "SELECT type, digests, last FROM samples WHERE ruri = ? AND type = ?");
  prepare.Into(all_samples_,
               "SELECT type, digests, last FROM samples WHERE ruri = ? ORDER BY type");
  prepare.Into(open_requests_,
               "SELECT request_id FROM operator_requests WHERE ruri = ? AND is_open");
  prepare.Into(close_request_,
               "UPDATE operator_requests SET is_open = 0, closed_at = ?3"
               " WHERE ruri = ?1 AND request_id = ?2 AND is_open");
  prepare.Into(trim_requests_,
               "DELETE FROM operator_requests WHERE rowid IN (SELECT rowid FROM operator_requests"
               " WHERE ruri = ? AND NOT is_open ORDER BY opened_at DESC, entry DESC"
               " LIMIT -1 OFFSET ?)");
  return prepare.status();
}

absl::StatusOr<std::optional<RobotHold>> ClaimTables::ClaimOn(std::string_view ruri) {
  return claim_on_->Select(ruri).First([](const Rows& row) { return *HoldIn(row, 0); });
}

absl::Status ClaimTables::Claim(const ClaimRequest& request, const RobotHold& claim) {
  return claim_->Run(request.robot->ruri, claim.owner, claim.epoch, request.at);
}

absl::Status ClaimTables::Use(std::string_view ruri, SystemTime at) { return use_->Run(ruri, at); }

absl::StatusOr<SampleMemory> ClaimTables::Samples(std::string_view ruri, std::uint32_t type) {
  auto memory = samples_->Select(ruri, std::int64_t{type}).First([](const Rows& row) {
    return SamplesIn(row);
  });
  if (!memory.ok()) return memory.status();
  if (!*memory) return SampleMemory{.type = type};
  return **std::move(memory);
}

absl::StatusOr<std::vector<SampleMemory>> ClaimTables::AllSamples(std::string_view ruri) {
  return all_samples_->Select(ruri).All([](const Rows& row) { return SamplesIn(row); });
}

absl::StatusOr<KnownRobot::RequestIds> ClaimTables::OpenRequests(std::string_view ruri) {
  KnownRobot::RequestIds ids;
  absl::Status read =
      open_requests_->Select(ruri).ForEach([&ids](const Rows& row) { ids.insert(TextIn(row, 0)); });
  if (!read.ok()) return read;
  return ids;
}

absl::Status ClaimTables::CloseRequest(const CommitRecord& record,
                                       const model::OperatorRequest& request) {
  const std::string& ruri = record.robot->ruri;
  absl::Status closed = close_request_->Run(ruri, request.request_id, record.received_at);
  if (!closed.ok()) return closed;
  return trim_requests_->Run(ruri, kClosedRequestsPerRobotMax);
}

}  // namespace uplink::storage::sqlite
