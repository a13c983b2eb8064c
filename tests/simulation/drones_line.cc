#include "tests/simulation/drones_line.h"

namespace uplink::simulation {

template <typename Call>
auto DronesLine::Pass(const Call& call) -> decltype(call()) {
  const StoreFault fault = std::exchange(fault_, StoreFault::kNone);
  if (away_ || fault == StoreFault::kBefore) return absl::UnavailableError("ordered");
  auto answer = call();
  if (fault == StoreFault::kAfter) return absl::UnavailableError("ordered, answer lost");
  return answer;
}

absl::StatusOr<std::vector<storage::OpenResult>> DronesLine::OpenStreams(
    std::span<const storage::OpenRequest> requests) {
  return Pass([&] { return store_.OpenStreams(requests); });
}

absl::StatusOr<std::vector<storage::AdoptResult>> DronesLine::Adopt(
    std::span<const storage::AdoptRequest> requests) {
  return Pass([&] { return store_.Adopt(requests); });
}

absl::StatusOr<std::vector<storage::ClaimResult>> DronesLine::ClaimDrones(
    std::span<const storage::ClaimRequest> requests) {
  return Pass([&] {
    auto results = store_.ClaimDrones(requests);
    if (results.ok()) book_.NoteClaims(process_, requests, *results);
    return results;
  });
}

absl::StatusOr<std::vector<storage::Outcome>> DronesLine::Commit(const storage::Batch& batch) {
  return Pass([&] {
    auto outcomes = store_.Commit(batch);
    if (outcomes.ok()) book_.NoteCommit(process_, batch, *outcomes);
    return outcomes;
  });
}

absl::StatusOr<storage::Swept> DronesLine::Sweep(SystemTime now) {
  return Pass([&] { return store_.Sweep(now); });
}

absl::StatusOr<std::size_t> DronesLine::CloseRuns(SystemTime now) {
  return Pass([&] { return store_.CloseRuns(now); });
}

absl::StatusOr<std::vector<storage::ProcessId>> DronesLine::ProcessesWithOpenConnections() {
  return Pass([&] { return store_.ProcessesWithOpenConnections(); });
}

absl::StatusOr<std::size_t> DronesLine::EndConnections(const storage::ProcessId& process,
                                                       SystemTime now) {
  return Pass([&] { return store_.EndConnections(process, now); });
}

absl::StatusOr<storage::Trimmed> DronesLine::TrimQuarantine(std::span<const std::string> ruris) {
  return Pass([&] { return store_.TrimQuarantine(ruris); });
}

absl::StatusOr<storage::Erased> DronesLine::Retain(SystemTime now) {
  return Pass([&] { return store_.Retain(now); });
}

absl::StatusOr<std::vector<std::size_t>> DronesLine::Checkpoint(
    std::span<const storage::LiveRow> rows) {
  return Pass([&] { return store_.Checkpoint(rows); });
}

absl::StatusOr<std::vector<storage::FoundRobot>> DronesLine::Compare(
    std::span<const storage::ToldRobot> robots) {
  return Pass([&] { return store_.Compare(robots); });
}

}  // namespace uplink::simulation
