#include "storage/postgres/write/open_streams.h"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "schema/base/check.h"
#include "storage/postgres/write/holds.h"
#include "storage/postgres/write/open_calls.h"
#include "storage/postgres/write/transaction.h"
#include "storage/read_row.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kDoing = "open streams";

/// Puts each request into the first wave that does not name its robot yet.
std::vector<Wave> WavesOf(std::span<const OpenRequest> requests) {
  std::vector<Wave> waves;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const std::string_view ruri = requests[i].robot->ruri;
    auto wave = std::ranges::find_if(waves, [&](const Wave& one) { return !one.contains(ruri); });
    if (wave == waves.end()) wave = waves.emplace(waves.end());
    wave->emplace(ruri, i);
  }
  return waves;
}

/// Those of the wave that the store has in another fleet than their requests say.
void TakeFleets(const Wave& wave, std::span<const OpenRequest> requests, const Result& fleets,
                std::vector<OpenResult>& results) {
  for (const ResultRow& row : fleets) {
    const auto found = wave.find(row.Bytes(0));
    UPLINK_CHECK(found != wave.end(), "an answer of a robot that was not asked for");
    const std::string_view fleet = row.Bytes(1);
    if (fleet == requests[found->second].robot->fleet) continue;
    results[found->second].other_fleet = std::string(fleet);
  }
}

/// `answers` are those of CallsOf, from the first on.
void Take(const Wave& wave, std::span<const OpenRequest> requests, std::span<const Result> answers,
          std::vector<OpenResult>& results) {
  const auto result_of = [&](const ResultRow& row) -> OpenResult& {
    const auto found = wave.find(row.Bytes(0));
    UPLINK_CHECK(found != wave.end(), "an answer of a robot that was not asked for");
    return results[found->second];
  };
  for (const auto& [name, index] : wave) results[index].taken = false;
  for (const ResultRow& row : answers[kRobotsAnswer]) {
    const std::size_t index = wave.find(row.Bytes(0))->second;
    OpenResult& result = results[index];
    result.taken = true;
    if (!row.Null(3) && row.Bytes(3) != requests[index].robot->fleet) {
      result.moved_from = std::string(row.Bytes(3));
    }
    result.epoch = static_cast<Epoch>(row.Int(1));
    result.held_since = static_cast<Epoch>(row.Int(2));
    result.was_known = result.epoch != 0;
  }
  for (const ResultRow& row : answers[kNewRobotsAnswer]) {
    OpenResult& result = result_of(row);
    result.epoch = result.held_since = static_cast<Epoch>(row.Int(1));
  }
  for (const ResultRow& row : answers[kSessionsAnswer]) {
    result_of(row).cursor = static_cast<model::Seq>(row.Int(1));
  }
  TakePresence(answers[kPresenceAnswer], [&](std::string_view name, StoredPresence presence) {
    OpenResult& result = results[wave.find(name)->second];
    if (result.taken) result.presence = presence;
  });
  for (const ResultRow& row : answers[kRejectsAnswer]) {
    const std::size_t index = wave.find(row.Bytes(0))->second;
    if (!results[index].taken) continue;
    if (results[index].rejects.size() == requests[index].rejects_max) continue;
    results[index].rejects.push_back(RejectIn(row, 1));
  }
  for (const ResultRow& row : answers[kLatestKindsAnswer]) {
    OpenResult& result = result_of(row);
    if (result.taken) result.latest_kinds |= BitOf(static_cast<LatestKind>(row.Int(1)));
  }
  for (const ResultRow& row : answers[kRejectCountsAnswer]) {
    OpenResult& result = result_of(row);
    if (result.taken) result.rejects_total = static_cast<std::size_t>(row.Int(1));
  }
  TakeFleets(wave, requests, answers[kFleetsAnswer], results);
}

}  // namespace

absl::StatusOr<std::vector<OpenResult>> OpenAll(
    Connection& connection, std::span<const OpenRequest> requests, const ProcessId& process,
    const std::function<absl::Status()>& before_commit) {
  std::vector<OpenResult> results(requests.size());
  const std::vector<Wave> waves = WavesOf(requests);
  std::vector<StoreCall> calls = BeginCalls();
  std::vector<std::size_t> firsts;
  for (const Wave& wave : waves) {
    firsts.push_back(calls.size());
    std::ranges::move(CallsOf(wave, requests, process), std::back_inserter(calls));
  }
  const auto answers = RunAndCommitFor(connection, std::move(calls), kDoing, before_commit);
  if (!answers.ok()) return Decisive(answers.status());
  for (std::size_t i = 0; i < waves.size(); ++i) {
    Take(waves[i], requests, std::span(*answers).subspan(firsts[i]), results);
  }
  return results;
}

}  // namespace uplink::storage::postgres
