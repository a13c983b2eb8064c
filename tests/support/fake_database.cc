#include "tests/support/fake_database.h"

#include <algorithm>
#include <iterator>
#include <variant>

#include "schema/base/check.h"
#include "schema/model/record.h"
#include "storage/refusal.h"

namespace uplink::testing {

using model::Fault;
using model::Record;
using model::Rejection;
using model::Seq;
using model::SessionId;
using storage::CommitRecord;
using storage::GapItem;
using storage::OpenRequest;
using storage::OpenResult;
using storage::Outcome;
using storage::OutcomeKind;
using storage::ProcessId;
using storage::QuarantineItem;

FakeDatabase::FakeDatabase() = default;

FakeDatabase::~FakeDatabase() = default;

std::vector<OpenResult> FakeDatabase::OpenStreams(const ProcessId& process,
                                                  std::span<const OpenRequest> requests) {
  const std::lock_guard lock(mutex_);
  std::vector<OpenResult> results;
  results.reserve(requests.size());
  for (const OpenRequest& request : requests) results.push_back(OpenOne(process, request));
  return results;
}

std::vector<Outcome> FakeDatabase::Commit(const ProcessId& process, const storage::Batch& batch,
                                          const FakeRules& rules,
                                          const storage::StoreRules& store_rules) {
  const std::lock_guard lock(mutex_);
  ++transactions_;
  const Transaction transaction{process, rules, store_rules};
  std::vector<Outcome> outcomes;
  outcomes.reserve(batch.records.size());
  const storage::SampleMark* sample = nullptr;
  std::optional<OutcomeKind> of_sample;
  for (const CommitRecord& record : batch.records) {
    if (record.sample == nullptr) {
      outcomes.push_back(CommitOne(transaction, record));
      continue;
    }
    if (record.sample.get() != sample) of_sample = LookAtSample(transaction, record);
    sample = record.sample.get();
    outcomes.push_back(
        of_sample ? Outcome{*of_sample, std::nullopt}
                  : WriteNew(transaction, *FindRobot(record.robot->ruri), nullptr, record));
  }
  topics_.Write(batch, process, outcomes);
  for (const GapItem& gap : batch.gaps) WriteGap(process, gap);
  for (const storage::ConnectionItem& item : batch.connections) {
    if (FindRobot(item.robot->ruri) != nullptr) connections_.Write(item, ++entries_);
  }
  for (const storage::ConnectionItem& item : batch.connections) {
    connections_.Trim(item.robot->ruri);
  }
  const auto is_fenced = [&](const storage::PresenceItem& item) {
    return !rules.presence_without_hold && IsFenced(process, item.robot, item.held_since);
  };
  std::ranges::move(presence_.Write(batch, entries_, is_fenced, rules.presence_without_cursor),
                    std::back_inserter(outcomes));
  return outcomes;
}

std::vector<storage::AdoptResult> FakeDatabase::Adopt(
    const ProcessId& process, std::span<const storage::AdoptRequest> requests) {
  const std::lock_guard lock(mutex_);
  std::vector<storage::AdoptResult> results(requests.size());
  for (std::size_t i = 0; i < requests.size(); ++i) {
    Robot* const robot = FindRobot(requests[i].robot->ruri);
    if (robot == nullptr) continue;
    if (robot->owner != process) {
      if (robot->owner != requests[i].holder) continue;
      if (leases_.RenewedSince(requests[i].holder, requests[i].lease_counter)) continue;
      robot->owner = process;
      robot->held_since = robot->epoch = DrawEpoch(*robot);
      if (requests[i].end == storage::HolderEnd::kSilent) robot->end = requests[i].end;
    }
    results[i] = {robot->held_since, presence_.Last(requests[i].robot->ruri), robot->end};
  }
  return results;
}

std::vector<storage::ForeignRobot> FakeDatabase::RobotsOfOthers(const ProcessId& process,
                                                                std::string_view after) const {
  const std::lock_guard lock(mutex_);
  std::vector<storage::ForeignRobot> robots;
  for (auto row = robots_.upper_bound(after);
       row != robots_.end() && robots.size() < storage::kForeignRobotsMax; ++row) {
    const Robot& robot = row->second;
    if (robot.epoch == 0 || robot.owner == process || storage::IsNoRobot(row->first)) continue;
    storage::ForeignRobot foreign{.robot = robot.id,
                                  .holder = robot.owner,
                                  .held_since = robot.held_since,
                                  .presence = presence_.Last(row->first)};
    if (foreign.presence) foreign.written_at = foreign.presence->since;
    foreign.last_session = robot.settled;
    SystemTime used;
    for (const auto& [id, session] : robot.sessions) {
      if (robot.settled || (foreign.last_session && session.last_used < used)) continue;
      foreign.last_session = {id, session.cursor};
      used = session.last_used;
    }
    robots.push_back(std::move(foreign));
  }
  return robots;
}

std::size_t FakeDatabase::Sweep(SystemTime now) {
  const std::lock_guard lock(mutex_);
  return kinds_.Sweep(now);
}

std::vector<std::size_t> FakeDatabase::Checkpoint(const ProcessId& process,
                                                  std::span<const storage::LiveRow> rows) {
  const std::lock_guard lock(mutex_);
  std::vector<std::size_t> passed_over;
  for (std::size_t place = 0; place < rows.size(); ++place) {
    const storage::LiveRow& row = rows[place];
    Robot* const robot = FindRobot(row.ruri);
    if (robot == nullptr || robot->owner != process || robot->held_since != row.held_since) {
      passed_over.push_back(place);
      continue;
    }
    storage::LiveRow& kept = live_[row.ruri];
    kept.ruri = row.ruri;
    kept.held_since = row.held_since;
    if (row.last_sign_of_life) kept.last_sign_of_life = row.last_sign_of_life;
    if (row.clock_skew_ms) kept.clock_skew_ms = row.clock_skew_ms;
    if (row.session) robot->settled = row.session;
    for (std::size_t kind = 0; kind < storage::kLivePartKinds; ++kind) {
      if (row.parts[kind]) kept.parts[kind] = row.parts[kind];
    }
  }
  return passed_over;
}

OpenResult FakeDatabase::OpenOne(const ProcessId& process, const OpenRequest& request) {
  Robot& robot = robots_[request.robot->ruri];
  const bool was_known = robot.epoch != 0;
  const bool moves = was_known && robot.id.fleet != request.robot->fleet;
  OpenResult result;
  const bool refused = moves && request.fleet_word == storage::FleetWord::kMatches;
  if (refused) result.other_fleet = robot.id.fleet;
  result.taken = !refused && !(request.stream == storage::StreamState::kEnded &&
                               robot.owner != process && leases_.Stands(robot.owner));
  if (!result.taken) return result;
  if (!was_known) robot.first_seen = robot.last_seen = request.at;
  if (moves) result.moved_from = robot.id.fleet;
  if (moves) MoveItems(robot, *request.robot);
  robot.id = *request.robot;
  robot.end = storage::HolderEnd::kEnded;
  robot.last_seen = std::max(robot.last_seen, request.at);
  robot.last_opened = std::max(robot.last_opened, request.at);
  robot.epoch = DrawEpoch(robot);
  if (!was_known || robot.owner != process) {
    robot.owner = process;
    robot.held_since = robot.epoch;
  }
  Session& session = SessionOf(robot, request.session);
  session.last_used = std::max(session.last_used, request.at);
  session.settled = std::max(session.settled, std::min(request.settled_seq, session.cursor));
  session.rejects.Confirm(session.settled);

  result.was_known = was_known;
  result.epoch = robot.epoch;
  result.held_since = robot.held_since;
  result.presence = presence_.Last(request.robot->ruri);
  result.latest_kinds = kinds_.LatestKinds(request.robot->ruri);
  result.cursor = session.cursor;
  result.rejects =
      session.rejects.Between(request.settled_seq, session.cursor,
                              std::max(request.rejects_max, storage::kQuarantineRowsPerRobotMax));
  result.rejects_total = std::min(result.rejects.size(), storage::kQuarantineRowsPerRobotMax);
  result.rejects.resize(std::min(result.rejects.size(), request.rejects_max));
  EvictSessions(robot, request);
  return result;
}

void FakeDatabase::EvictSessions(Robot& robot, const OpenRequest& request) {
  while (robot.sessions.size() > storage::kSessionsPerRobotMax) {
    auto oldest = robot.sessions.end();
    for (auto it = robot.sessions.begin(); it != robot.sessions.end(); ++it) {
      if (it->first == request.session) continue;
      if (std::ranges::find(request.sessions_held, it->first) != request.sessions_held.end()) {
        continue;
      }
      if (oldest == robot.sessions.end() || it->second.last_used < oldest->second.last_used) {
        oldest = it;
      }
    }
    if (oldest == robot.sessions.end()) return;
    robot.sessions.erase(oldest);
  }
}

FakeDatabase::Robot* FakeDatabase::FindRobot(std::string_view ruri) {
  const auto found = robots_.find(ruri);
  return found == robots_.end() || found->second.epoch == 0 ? nullptr : &found->second;
}

storage::Epoch FakeDatabase::DrawEpoch(const Robot& robot) {
  return epochs_in_each_row_ ? robot.epoch + 1 : ++epochs_;
}

void FakeDatabase::DeleteRobotRow(std::string_view ruri) {
  const std::lock_guard lock(mutex_);
  Robot* const robot = FindRobot(ruri);
  if (robot == nullptr) return;
  robot->epoch = robot->held_since = 0;
  robot->owner = {};
  robot->end = storage::HolderEnd::kEnded;
}

void FakeDatabase::RemoveRobot(const std::string& ruri) {
  DeleteRobotRow(ruri);
  const std::lock_guard lock(mutex_);
  const auto robot = robots_.find(ruri);
  if (robot != robots_.end()) {
    robot->second.claim.reset();
    robot->second.samples.clear();
  }
  kinds_.DeletePresent(ruri);
  connections_.DeleteAll(ruri);
  access_.DropNotes(ruri);
}

Outcome FakeDatabase::CommitOne(const Transaction& transaction, const CommitRecord& record) {
  UPLINK_CHECK(record.seq <= model::kSeqMax, "a number past the contract's reached the store");
  if (transaction.rules.batches_make_robots && FindRobot(record.robot->ruri) == nullptr) {
    Robot& made = robots_[record.robot->ruri];
    made.id = *record.robot;
    made.epoch = made.held_since = record.held_since;
    made.owner = transaction.process;
  }
  const ProcessId& process = transaction.process;
  const bool lease_stands = topics_.Stands(storage::HoldOf(record.origin), process);
  if (!lease_stands || IsFenced(process, record.robot, record.held_since)) {
    return {OutcomeKind::kFenced, std::nullopt};
  }
  Robot& robot = *FindRobot(record.robot->ruri);
  Session& session = SessionOf(robot, record.session);
  if (record.seq <= session.cursor) {
    if (transaction.rules.allow_cursor_lowering) session.cursor = record.seq;
    if (auto why = session.rejects.Of(record.seq)) return {OutcomeKind::kRefused, std::move(why)};
    return {OutcomeKind::kDuplicate, std::nullopt};
  }

  session.cursor = record.seq;
  session.last_used = std::max(session.last_used, record.received_at);
  return WriteNew(transaction, robot, &session, record);
}

Outcome FakeDatabase::WriteNew(const Transaction& transaction, Robot& robot, Session* session,
                               const CommitRecord& record) {
  robot.last_seen = std::max(robot.last_seen, record.received_at);
  Outcome outcome;
  bool quarantined = true;
  if (const auto* item = std::get_if<QuarantineItem>(&record.content)) {
    WriteQuarantine(robot, session, record, item->rejection);
  } else if (const auto* range = std::get_if<storage::LimitedRange>(&record.content)) {
    UPLINK_CHECK(session != nullptr, "no sample is a range");
    session->rejects.AddRange(*range, record.seq);
    for (Seq seq = range->first; seq <= record.seq; ++seq) {
      robot.logs[record.session].quarantined[seq] = range->rejection;
      if (seq < record.seq) ++robot.logs[record.session].times_written[seq];
    }
  } else if (std::optional<Rejection> refusal = Refusal(transaction, robot, record)) {
    WriteQuarantine(robot, session, record, *refusal);
    outcome = {OutcomeKind::kRefused, std::move(refusal)};
  } else {
    WriteRecord(transaction, robot, record);
    quarantined = false;
  }
  ++robot.logs[record.session].times_written[record.seq];
  applications_.push_back({record.robot, record.session, record.seq, quarantined, record.held_since,
                           transaction.process, transactions_});
  return outcome;
}

std::optional<Rejection> FakeDatabase::Refusal(const Transaction& transaction, const Robot& robot,
                                               const CommitRecord& record) const {
  if (std::holds_alternative<model::ScopeUpdate>(record.content)) return std::nullopt;
  if (std::holds_alternative<model::OperatorRequest>(record.content)) {
    return kinds_.Refusal(record, transaction.store_rules);
  }
  const auto& good = std::get<Record>(record.content);
  UPLINK_CHECK(good.durable(), "a live record reached the store");
  const auto* fault = std::get_if<Fault>(&good.body());
  if (fault != nullptr && fault->active &&
      robot.faults_active.size() >= storage::kActiveFaultsPerRobotMax &&
      !robot.faults_active.contains({fault->fault_id, fault->source})) {
    return storage::TooManyActiveFaults();
  }
  if (std::optional<Rejection> refusal = kinds_.Refusal(record, transaction.store_rules)) {
    return refusal;
  }
  if (transaction.rules.refuse) return transaction.rules.refuse(record);
  return std::nullopt;
}

void FakeDatabase::WriteRecord(const Transaction& transaction, Robot& robot,
                               const CommitRecord& record) {
  const auto* good = std::get_if<Record>(&record.content);
  const auto* fault = good == nullptr ? nullptr : std::get_if<Fault>(&good->body());
  if (fault != nullptr) {
    WriteFault(robot, *fault, record);
  } else {
    kinds_.Write(record, ++entries_, transaction.store_rules);
  }
  robot.logs[record.session].stored.push_back(record.seq);
}

void FakeDatabase::MoveItems(Robot& robot, const model::RobotId& to) {
  kinds_.Move(to);
  for (auto& [key, entry] : robot.faults_active) entry.row.robot.fleet = to.fleet;
}

void FakeDatabase::WriteFault(Robot& robot, const Fault& fault, const CommitRecord& record) {
  const SystemTime received_at = record.received_at;
  faults_history_.push_back(
      {received_at, ++entries_, {*record.robot, fault, received_at, std::nullopt}});
  FaultKey key{fault.fault_id, fault.source};
  if (!fault.active) {
    robot.faults_active.erase(key);
    return;
  }
  const auto [it, raised] = robot.faults_active.try_emplace(std::move(key));
  FakeEntry<storage::FaultRow>& entry = it->second;
  if (raised) {
    entry.at = received_at;
    entry.entry = entries_;
  }
  entry.row = {*record.robot, fault, received_at, entry.at};
}

void FakeDatabase::WriteQuarantine(Robot& robot, Session* session, const CommitRecord& record,
                                   const Rejection& rejection) {
  if (session != nullptr) session->rejects.Add(record.seq, rejection);
  robot.logs[record.session].quarantined[record.seq] = rejection;
  quarantine_.push_back({record.received_at,
                         ++entries_,
                         {*record.robot, record.session, record.seq, rejection, record.received_at,
                          record.payload, record.payload_bytes, storage::SourceOf(record.origin),
                          std::string(storage::TopicOf(record.origin))}});
  if (record.payload.empty()) return;
  robot.payload_rows.push_back(quarantine_.size() - 1);
  if (robot.payload_rows.size() > storage::kQuarantinePayloadsPerRobotMax) {
    quarantine_[robot.payload_rows.front()].row.payload.clear();
    robot.payload_rows.pop_front();
  }
}

void FakeDatabase::WriteGap(const ProcessId& process, const GapItem& gap) {
  if (IsFenced(process, gap.robot, gap.held_since)) return;
  Robot& robot = *FindRobot(gap.robot->ruri);
  const GapPlace place{gap.seen_at, ++entries_};
  const auto [known, fresh] = robot.gap_places.try_emplace({gap.session, gap.first}, place);
  if (!fresh) {
    Seq& last = robot.gaps.at(known->second).last;
    last = std::max(last, gap.last);
    return;
  }
  robot.gaps[place] = {*gap.robot, gap.session, gap.first, gap.last, gap.seen_at};
  if (robot.gaps.size() > storage::kGapsPerRobotMax) {
    const auto oldest = robot.gaps.begin();
    robot.gap_places.erase({oldest->second.session, oldest->second.first});
    robot.gaps.erase(oldest);
  }
}

std::optional<Seq> FakeDatabase::Cursor(std::string_view ruri, const SessionId& session) const {
  const std::lock_guard lock(mutex_);
  if (ruri == storage::kServerRuri) return presence_.Cursor(session);
  const auto robot = robots_.find(ruri);
  if (robot == robots_.end()) return std::nullopt;
  const auto found = robot->second.sessions.find(session);
  if (found == robot->second.sessions.end()) return std::nullopt;
  return found->second.cursor;
}

const SessionLog* FakeDatabase::FindLog(std::string_view ruri, const SessionId& session) const {
  const auto robot = robots_.find(ruri);
  if (robot == robots_.end()) return nullptr;
  const auto log = robot->second.logs.find(session);
  return log == robot->second.logs.end() ? nullptr : &log->second;
}

SessionLog FakeDatabase::Log(std::string_view ruri, const SessionId& session) const {
  const std::lock_guard lock(mutex_);
  const SessionLog* log = FindLog(ruri, session);
  return log == nullptr ? SessionLog() : *log;
}

std::vector<std::pair<std::string, SessionId>> FakeDatabase::Sessions() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::pair<std::string, SessionId>> sessions;
  for (const auto& [ruri, robot] : robots_) {
    for (const auto& [session, log] : robot.logs) sessions.emplace_back(ruri, session);
  }
  return sessions;
}

std::uint32_t FakeDatabase::TimesWritten(std::string_view ruri, const SessionId& session,
                                         Seq seq) const {
  const std::lock_guard lock(mutex_);
  const SessionLog* log = FindLog(ruri, session);
  if (log == nullptr) return 0;
  const auto times = log->times_written.find(seq);
  return times == log->times_written.end() ? 0 : times->second;
}

std::optional<Rejection> FakeDatabase::QuarantineReason(std::string_view ruri,
                                                        const SessionId& session, Seq seq) const {
  const std::lock_guard lock(mutex_);
  const SessionLog* log = FindLog(ruri, session);
  if (log == nullptr) return std::nullopt;
  const auto reason = log->quarantined.find(seq);
  if (reason == log->quarantined.end()) return std::nullopt;
  return reason->second;
}

storage::Epoch FakeDatabase::EpochOf(std::string_view ruri) const {
  const std::lock_guard lock(mutex_);
  const auto robot = robots_.find(ruri);
  return robot == robots_.end() ? 0 : robot->second.epoch;
}

}  // namespace uplink::testing
