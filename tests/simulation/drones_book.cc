#include "tests/simulation/drones_book.h"

#include <algorithm>
#include <string_view>
#include <variant>

#include <fmt/format.h>

#include "server/uncrew/stored_samples.h"
#include "tests/simulation/rows.h"

namespace uplink::simulation {
namespace {

using storage::OutcomeKind;

/// The kind of event that tells a change of the type.
std::string KindOf(SampleType mode) { return std::string(model::uncrew::RowOf(mode).name); }

/// `detail` is {"from":A,"to":B}, or {"to":B}.
struct Change {
  std::optional<std::string> from;
  std::string to;
};
std::optional<Change> ChangeIn(std::string_view detail) {
  constexpr std::string_view kFrom = "{\"from\":";
  constexpr std::string_view kTo = "\"to\":";
  const std::size_t to = detail.rfind(kTo);
  if (to == std::string_view::npos || !detail.ends_with('}')) return std::nullopt;
  Change change;
  change.to = detail.substr(to + kTo.size(), detail.size() - to - kTo.size() - 1);
  if (detail.starts_with(kFrom)) {
    change.from = detail.substr(kFrom.size(), to - kFrom.size() - 1);
  }
  return change;
}

/// What the drone called it; a rejected one is stored under a number of its own.
std::uint32_t StoredAs(const DroneSample& sample) {
  return uncrew::NumberOf(sample.bad ? SampleType::kRejected : sample.type);
}

}  // namespace

void DronesBook::NoteMade(const std::string& ruri, const DroneSampleRef& sample) {
  drones_[ruri].made.emplace(sample->digest, sample);
}

void DronesBook::NoteClaims(const storage::ProcessId& process,
                            std::span<const storage::ClaimRequest> requests,
                            std::span<const storage::ClaimResult> results) {
  for (std::size_t i = 0; i < requests.size(); ++i) {
    ++claims_;
    drones_[requests[i].robot->ruri].claim = {process, results[i].claim};
  }
}

void DronesBook::NoteCommit(const storage::ProcessId& process, const storage::Batch& batch,
                            std::span<const storage::Outcome> outcomes) {
  const std::span<const storage::CommitRecord> records(batch.records);
  std::size_t end = 0;
  for (std::size_t begin = 0; begin < records.size(); begin = end) {
    const storage::SampleRef& mark = records[begin].sample;
    end = begin + 1;
    if (mark == nullptr) continue;
    while (end < records.size() && records[end].sample == mark) ++end;
    const std::string& ruri = records[begin].robot->ruri;
    const Committed sample{ruri, drones_[ruri], records.subspan(begin, end - begin)};
    const OutcomeKind kind = outcomes[begin].kind;
    const auto of_sample = outcomes.subspan(begin, end - begin);
    if (!std::ranges::all_of(of_sample, [kind](const auto& one) { return one.kind == kind; })) {
      violation_(fmt::format("the records of {} have several outcomes", NameOf(sample)));
    }
    NoteSample(process, sample, kind);
  }
}

std::string DronesBook::NameOf(const Committed& sample) const {
  const auto made = sample.drone.made.find(sample.records.front().sample->digest);
  return sample.ruri + "'s " +
         (made == sample.drone.made.end() ? "sample that it did not make" : ToText(*made->second));
}

void DronesBook::NoteSample(const storage::ProcessId& process, const Committed& sample,
                            OutcomeKind outcome) {
  const storage::SampleMark& mark = *sample.records.front().sample;
  const bool claimed = sample.drone.claim == std::pair(process, mark.claim);
  if (outcome == OutcomeKind::kFenced) {
    ++fenced_;
    if (claimed) violation_(NameOf(sample) + " was fenced under the drone's own claim");
    return;
  }
  if (!claimed) {
    violation_(
        fmt::format("{} was looked at under claim {}, which is over", NameOf(sample), mark.claim));
  }
  if (mark.is_question) {
    if (outcome != OutcomeKind::kDuplicate) violation_("a question under a claim was not affirmed");
    return;
  }
  const Key key{mark.type, mark.digest};
  switch (outcome) {
    case OutcomeKind::kStored:
      if (!sample.drone.stored.insert(key).second) violation_(NameOf(sample) + " is stored twice");
      return NoteStored(sample);
    case OutcomeKind::kDuplicate:
      ++duplicates_;
      if (sample.drone.stored.contains(key)) return;
      return violation_(NameOf(sample) + " is called a duplicate and was never stored");
    default:
      return violation_(NameOf(sample) + " was refused");
  }
}

void DronesBook::NoteStored(const Committed& sample) {
  for (const storage::CommitRecord& record : sample.records) NoteRecord(sample, record.content);
  CheckSet(sample);
}

void DronesBook::NoteRecord(const Committed& sample, const storage::CommitContent& content) {
  if (std::holds_alternative<storage::QuarantineItem>(content)) {
    ++sample.drone.quarantined;
    return;
  }
  if (const auto* request = std::get_if<model::OperatorRequest>(&content)) {
    return Toggle(sample, SampleType::kOperatorRequests, request->request_id, request->open);
  }
  const model::Body& body = std::get<model::Record>(content).body();
  if (const auto* fault = std::get_if<model::Fault>(&body)) {
    ++sample.drone.fault_reports;
    return Toggle(sample, SampleType::kAlerts, fault->fault_id, fault->active);
  }
  if (const auto* message = std::get_if<model::Message>(&body)) {
    sample.drone.messages.insert(message->message);
    return;
  }
  const auto& event = std::get<model::EventTelemetry>(body);
  const auto& named = std::get<model::NamedEvent>(event.kind);
  sample.drone.events.emplace(named.kind, event.unix_time_ms);
  NoteChange(sample, named.kind, named.detail_json);
}

void DronesBook::NoteChange(const Committed& sample, const std::string& kind,
                            const std::string& detail) {
  const auto change = ChangeIn(detail);
  if (!change) return;
  const auto last = sample.drone.modes.find(kind);
  const std::optional<std::string> before =
      last == sample.drone.modes.end() ? std::nullopt : std::optional(last->second);
  if (change->from != before || change->to == before) {
    violation_(fmt::format("{} changes from {} to {}, and the last change was to {}",
                           NameOf(sample), change->from.value_or("nothing"), change->to,
                           before.value_or("nothing")));
  }
  sample.drone.modes[kind] = change->to;
}

void DronesBook::Toggle(const Committed& sample, SampleType set, const std::string& id,
                        bool active) {
  std::set<std::string>& now = sample.drone.active[set];
  const bool changed = active ? now.insert(id).second : now.erase(id) > 0;
  if (changed) return;
  violation_(fmt::format("{} says that {} {}, which it did before", NameOf(sample), id,
                         active ? "begins" : "ends"));
}

void DronesBook::CheckSet(const Committed& sample) {
  const auto made = sample.drone.made.find(sample.records.front().sample->digest);
  if (made == sample.drone.made.end()) return violation_(NameOf(sample) + " is stored");
  const SampleType type = made->second->type;
  if (!IsSetType(type) || sample.drone.active[type] == made->second->items) return;
  violation_(fmt::format("{} is stored, has {}, and the store has {}", NameOf(sample),
                         fmt::join(made->second->items, " "),
                         fmt::join(sample.drone.active[type], " ")));
}

bool DronesBook::Has(const std::string& ruri, const DroneSample& sample) const {
  const auto drone = drones_.find(ruri);
  return drone != drones_.end() && drone->second.stored.contains({StoredAs(sample), sample.digest});
}

const std::set<std::string>& DronesBook::Active(const std::string& ruri, SampleType set) {
  return drones_[ruri].active[set];
}

std::optional<std::string> DronesBook::Mode(const std::string& ruri, SampleType mode) const {
  const auto drone = drones_.find(ruri);
  if (drone == drones_.end()) return std::nullopt;
  const auto last = drone->second.modes.find(KindOf(mode));
  return last == drone->second.modes.end() ? std::nullopt : std::optional(last->second);
}

std::optional<std::string> DronesBook::Compare(storage::Reader& reader) const {
  for (const auto& [ruri, drone] : drones_) {
    if (auto difference = CompareOne(ruri, drone, reader)) return ruri + ": " + *difference;
  }
  return std::nullopt;
}

std::optional<std::string> DronesBook::CompareOne(const std::string& ruri, const OfDrone& drone,
                                                  storage::Reader& reader) const {
  using Query = storage::HistoryQuery;
  OfDrone found;
  for (const storage::EventRow& row : AllRows<storage::EventRow>(
           ruri, [&](const Query& query) { return reader.Events({.rows = query}); })) {
    found.events.emplace(row.kind, row.sampled_at_ms);
  }
  if (found.events != drone.events) return "its events are others than were committed";
  for (const storage::MessageRow& row : AllRows<storage::MessageRow>(
           ruri, [&](const Query& query) { return reader.Messages({.rows = query}); })) {
    found.messages.insert(row.message.message);
  }
  if (found.messages != drone.messages) return "its messages are others than were committed";
  for (const storage::FaultRow& row : AllRows<storage::FaultRow>(
           ruri, [&](const Query& query) { return reader.FaultsActive({.rows = query}); })) {
    found.active[SampleType::kAlerts].insert(row.fault.fault_id);
  }
  for (const storage::OperatorRequestRow& row :
       AllRows<storage::OperatorRequestRow>(ruri, [&](const Query& query) {
         return reader.OperatorRequests({.rows = query, .open = true});
       })) {
    found.active[SampleType::kOperatorRequests].insert(row.request_id);
  }
  for (const auto& [set, items] : drone.active) {
    if (found.active[set] != items) {
      return fmt::format("{} are {}, and {} were committed", KindOf(set),
                         fmt::join(found.active[set], " "), fmt::join(items, " "));
    }
  }
  const std::size_t reports = AllRows<storage::FaultRow>(ruri, [&](const Query& query) {
                                return reader.FaultHistory({.rows = query});
                              }).size();
  if (reports != drone.fault_reports) {
    return fmt::format("{} fault reports, {} were committed", reports, drone.fault_reports);
  }
  const std::size_t rejected =
      AllRows<storage::QuarantineRow>(ruri, [&](const Query& query) {
        return reader.Quarantine({.rows = query, .source = model::MessageSource::kUncrew});
      }).size();
  if (rejected != drone.quarantined) {
    return fmt::format("{} in quarantine, {} were committed", rejected, drone.quarantined);
  }
  return std::nullopt;
}

}  // namespace uplink::simulation
