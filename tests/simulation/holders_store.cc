#include "tests/simulation/holders_store.h"

#include <algorithm>
#include <utility>

namespace uplink::simulation {

HoldersStore::HoldersStore(Context context)
    : context_(std::move(context)), store_(context_.database, context_.process) {}

bool HoldersStore::Reaches() {
  if (!std::exchange(broken_, false)) return !away_;
  store_.Break();
  return false;
}

template <typename Call>
auto HoldersStore::Pass(const Call& call) -> decltype(call()) {
  const absl::Status lost = absl::UnavailableError("the simulation said so");
  if (!Reaches()) return lost;
  const bool fails = context_.random.Percent(lost_percent_);
  if (fails && context_.random.Percent(50)) return lost;
  auto answer = call();
  if (fails) return lost;
  return answer;
}

absl::StatusOr<std::vector<storage::OpenResult>> HoldersStore::OpenStreams(
    std::span<const storage::OpenRequest> requests) {
  std::vector<storage::OpenRequest> asked(requests.begin(), requests.end());
  if (context_.fault == HoldersFault::kEndedStreamTakes) {
    for (storage::OpenRequest& request : asked) request.stream = storage::StreamState::kOpen;
  }
  return Pass([&] {
    const auto before = context_.truth.Holds();
    auto results = store_.OpenStreams(asked);
    for (std::size_t i = 0; i < asked.size(); ++i) {
      if (!(*results)[i].taken) continue;
      context_.truth.OnOpened(context_.process, asked[i].robot->ruri, before, context_.has_stream);
    }
    return results;
  });
}

void HoldersStore::TrustRows(std::vector<storage::AdoptRequest>& requests) const {
  auto holds = context_.truth.Holds();
  const std::vector<storage::Lease> leases = context_.database.ReadLeases();
  for (storage::AdoptRequest& request : requests) {
    request.holder = holds[request.robot->ruri].holder;
    const auto lease = std::ranges::find(leases, request.holder, &storage::Lease::process);
    if (lease != leases.end()) request.lease_counter = lease->counter;
  }
}

absl::StatusOr<std::vector<storage::AdoptResult>> HoldersStore::Adopt(
    std::span<const storage::AdoptRequest> requests) {
  return Pass([&] {
    const auto before = context_.truth.Holds();
    std::vector<storage::AdoptRequest> asked(requests.begin(), requests.end());
    if (context_.fault == HoldersFault::kAdoptedWithoutCompare) TrustRows(asked);
    auto results = store_.Adopt(asked);
    context_.truth.OnAdopted(context_.process, before);
    if (context_.fault == HoldersFault::kSilenceForgotten) {
      for (std::size_t i = 0; i < asked.size(); ++i) (*results)[i].end = asked[i].end;
    }
    return results;
  });
}

absl::StatusOr<std::vector<storage::ClaimResult>> HoldersStore::ClaimDrones(
    std::span<const storage::ClaimRequest> requests) {
  return Pass([&] { return store_.ClaimDrones(requests); });
}

absl::StatusOr<std::vector<storage::Outcome>> HoldersStore::Commit(const storage::Batch& batch) {
  testing::FakeRules rules;
  rules.presence_without_hold = context_.fault == HoldersFault::kHoldNotChecked;
  store_.SetRules(std::move(rules));
  return Pass([&] {
    auto outcomes = store_.Commit(batch);
    for (std::size_t i = 0; i < batch.presence.size(); ++i) {
      if ((*outcomes)[batch.records.size() + i].kind != storage::OutcomeKind::kStored) continue;
      context_.truth.OnWritten(context_.process, batch.presence[i]);
    }
    return outcomes;
  });
}

absl::StatusOr<storage::Swept> HoldersStore::Sweep(SystemTime now) {
  return Pass([&] { return store_.Sweep(now); });
}

absl::StatusOr<std::size_t> HoldersStore::CloseRuns(SystemTime now) {
  if (!Reaches()) return absl::UnavailableError("the line is cut");
  return store_.CloseRuns(now);
}

absl::StatusOr<std::vector<storage::ProcessId>> HoldersStore::ProcessesWithOpenConnections() {
  if (!Reaches()) return absl::UnavailableError("the line is cut");
  return store_.ProcessesWithOpenConnections();
}

absl::StatusOr<std::size_t> HoldersStore::EndConnections(const storage::ProcessId& process,
                                                         SystemTime now) {
  if (!Reaches()) return absl::UnavailableError("the line is cut");
  return store_.EndConnections(process, now);
}

std::size_t HoldersStore::TakeRunsClosed() { return store_.TakeRunsClosed(); }

absl::StatusOr<storage::Trimmed> HoldersStore::TrimQuarantine(std::span<const std::string> ruris) {
  if (!Reaches()) return absl::UnavailableError("the line is cut");
  return store_.TrimQuarantine(ruris);
}

absl::StatusOr<storage::Erased> HoldersStore::Retain(SystemTime now) {
  return Pass([&] { return store_.Retain(now); });
}

absl::StatusOr<std::vector<std::size_t>> HoldersStore::Checkpoint(
    std::span<const storage::LiveRow> rows) {
  return Pass([&] { return store_.Checkpoint(rows); });
}

bool HoldersStore::InDoubt() const { return store_.InDoubt(); }

absl::StatusOr<std::vector<storage::FoundRobot>> HoldersStore::Compare(
    std::span<const storage::ToldRobot> robots) {
  return Pass([&] { return store_.Compare(robots); });
}

void HoldersStore::EndDoubt() {
  store_.EndDoubt();
  context_.truth.NoteCompared(context_.process);
}

HoldersLeases::HoldersLeases(HoldersStore& line, const HoldersStore::Context& context)
    : line_(line), context_(context), leases_(context_.database, context_.process) {}

testing::FakeLeases& HoldersLeases::Now() {
  if (line_.TakeLeaseBreak()) leases_.Break();
  leases_.SetAway(line_.away());
  return leases_;
}

absl::Status HoldersLeases::Renew(const storage::ProcessCard& /*card*/) {
  absl::Status renewed = Now().Renew({.name = context_.name, .life = context_.name});
  if (renewed.ok()) context_.truth.NoteRenewed(context_.process);
  failed_ = failed_ || !renewed.ok();
  return renewed;
}

absl::Status HoldersLeases::Release() {
  absl::Status released = Now().Release();
  context_.truth.NoteEnded(
      context_.process, released.ok() ? HoldersTruth::End::kReleased : HoldersTruth::End::kKilled);
  return released;
}

absl::StatusOr<std::vector<storage::Lease>> HoldersLeases::Read() {
  auto leases = Now().Read();
  failed_ = failed_ || !leases.ok();
  if (leases.ok()) {
    for (storage::Lease& lease : *leases) {
      lease.renewed_ago =
          std::chrono::floor<std::chrono::seconds>(context_.truth.RenewedAgo(lease.process));
    }
  }
  if (!leases.ok() || !failed_ || context_.fault != HoldersFault::kOverAfterAFailedLook) {
    return leases;
  }
  for (storage::Lease& lease : *leases) lease.released = true;
  return leases;
}

absl::StatusOr<std::vector<storage::ForeignRobot>> HoldersLeases::RobotsOfOthers(
    std::string_view after) {
  return Now().RobotsOfOthers(after);
}

}  // namespace uplink::simulation
