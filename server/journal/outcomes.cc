#include "server/journal/outcomes.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <unordered_map>
#include <utility>

namespace uplink::journal {
namespace {

storage::Outcome OutcomeOf(const Origin& origin, storage::Outcome told) {
  // A number is taken once, so a record that the store has already is from an earlier try of ours:
  // it was stored, once, and is counted so.
  if (origin.tried && told.kind == storage::OutcomeKind::kDuplicate) {
    told.kind = storage::OutcomeKind::kStored;
  }
  return told;
}

std::optional<model::RejectReason> RejectedFor(const storage::CommitRecord& record) {
  if (const auto* item = std::get_if<storage::QuarantineItem>(&record.content)) {
    return item->rejection.reason;
  }
  const auto* range = std::get_if<storage::LimitedRange>(&record.content);
  return range != nullptr ? std::optional(range->rejection.reason) : std::nullopt;
}

robot::Settled SettledOf(const storage::CommitRecord& record, const Origin& origin,
                         storage::Outcome outcome) {
  const auto* range = std::get_if<storage::LimitedRange>(&record.content);
  return {.session = record.session,
          .seq = record.seq,
          .first = range != nullptr ? std::optional(range->first) : std::nullopt,
          .outcome = std::move(outcome),
          .rejected_for = RejectedFor(record),
          .arrived = origin.arrived,
          .bytes = origin.bytes};
}

/// The outcomes of one commit by robot, in order of first appearance, so that a run repeats
/// exactly.
struct ByClient {
  std::vector<std::pair<robot::CommitClient*, std::vector<robot::Settled>>> settled;
  /// A client whose hold has ended, with its robot; null for a drone, whose claim has ended.
  std::vector<std::pair<robot::CommitClient*, storage::RobotRef>> fenced;
};

ByClient Sort(const GatheredBatch& batch, std::vector<storage::Outcome> outcomes) {
  ByClient sorted;
  std::unordered_map<robot::CommitClient*, std::size_t> index;
  for (std::size_t i = 0; i < batch.origins().size(); ++i) {
    const Origin& origin = batch.origins()[i];
    if (origin.IsVoid()) continue;
    storage::Outcome outcome = OutcomeOf(origin, std::move(outcomes[i]));
    if (outcome.kind == storage::OutcomeKind::kFenced) {
      const auto client = [](const auto& fenced) { return fenced.first; };
      if (std::ranges::find(sorted.fenced, origin.client.get(), client) == sorted.fenced.end()) {
        sorted.fenced.emplace_back(origin.client.get(),
                                   origin.is_sample ? nullptr : batch.batch().records[i].robot);
      }
      continue;
    }
    const auto [at, first] = index.try_emplace(origin.client.get(), sorted.settled.size());
    if (first) sorted.settled.emplace_back(origin.client.get(), std::vector<robot::Settled>{});
    sorted.settled[at->second].second.push_back(
        SettledOf(batch.batch().records[i], origin, std::move(outcome)));
  }
  return sorted;
}

}  // namespace

std::vector<loop::StreamRef> TellOutcomes(const GatheredBatch& batch,
                                          std::vector<storage::Outcome> outcomes, Holds& holds,
                                          metrics::Ledger& ledger) {
  const ByClient sorted = Sort(batch, std::move(outcomes));
  std::vector<loop::StreamRef> wake;
  wake.reserve(sorted.settled.size() + sorted.fenced.size());
  for (const auto& [client, settled] : sorted.settled) {
    wake.push_back(client->OnSettled(settled, ledger));
  }
  for (const auto& [client, robot] : sorted.fenced) {
    wake.push_back(robot == nullptr ? client->OnFenced(ledger) : holds.Lose(*client, robot));
  }
  for (const Origin& origin : batch.gap_origins()) wake.push_back(origin.client->OnGapsWritten(1));
  std::ranges::copy(batch.commit_waiters(), std::back_inserter(wake));
  return wake;
}

}  // namespace uplink::journal
