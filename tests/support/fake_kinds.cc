#include "tests/support/fake_kinds.h"

#include <algorithm>
#include <string_view>
#include <variant>

#include "schema/json/text.h"
#include "storage/bounds.h"
#include "storage/expiry.h"
#include "storage/refusal.h"

namespace uplink::testing {

using storage::CommitRecord;
using storage::LatestKind;

namespace {

const model::Body& BodyOf(const CommitRecord& record) {
  return std::get<model::Record>(record.content).body();
}

}  // namespace

std::optional<model::Rejection> FakeKinds::Refusal(const CommitRecord& record,
                                                   const storage::StoreRules& rules) const {
  if (const auto* request = std::get_if<model::OperatorRequest>(&record.content)) {
    if (TakesRequest(record, *request)) return std::nullopt;
    return storage::TooManyOpenRequests();
  }
  const std::string& ruri = record.robot->ruri;
  const std::int64_t now_ms = storage::ExpiredByMs(record.received_at, rules);
  const auto* shape = std::get_if<model::ShapeOp>(&BodyOf(record));
  if (shape != nullptr && shape->upsert() != nullptr && !shapes_.Takes(ruri, shape->id(), now_ms)) {
    return storage::TooManyShapes();
  }
  const auto* object = std::get_if<model::ObjectOp>(&BodyOf(record));
  if (object != nullptr && object->upsert() != nullptr &&
      !objects_.Takes(ruri, object->id(), now_ms)) {
    return storage::TooManyObjects();
  }
  return std::nullopt;
}

void FakeKinds::Write(const CommitRecord& record, std::uint64_t entry,
                      const storage::StoreRules& rules) {
  const Target target{record, entry, rules};
  if (const auto* update = std::get_if<model::ScopeUpdate>(&record.content)) {
    const SystemTime at = record.received_at;
    scope_updates_.push_back({at, entry, {*record.robot, *update, at}});
    return;
  }
  if (const auto* request = std::get_if<model::OperatorRequest>(&record.content)) {
    WriteRequest(target, *request);
    return;
  }
  const model::Body& body = BodyOf(record);
  if (const auto* event = std::get_if<model::EventTelemetry>(&body)) {
    WriteEvent(target, *event);
  } else if (const auto* message = std::get_if<model::Message>(&body)) {
    WriteMessage(target, *message);
  } else if (const auto* report = std::get_if<model::MissionRunStatus>(&body)) {
    WriteReport(target, *report);
  } else if (const auto* shape = std::get_if<model::ShapeOp>(&body)) {
    WriteShape(target, *shape);
  } else if (const auto* object = std::get_if<model::ObjectOp>(&body)) {
    WriteObject(target, *object);
  } else if (const auto* agent = std::get_if<model::AgentInfo>(&body)) {
    WriteLatest(target, LatestKind::kAgentInfo, json::Text(*agent));
  } else if (const auto* settings = std::get_if<model::CurrentSettings>(&body)) {
    WriteLatest(target, LatestKind::kSettings, json::Text(*settings));
  } else if (const auto* capabilities = std::get_if<model::UiCapabilities>(&body)) {
    WriteLatest(target, LatestKind::kUiCapabilities, json::Text(*capabilities));
  }
}

void FakeKinds::WriteEvent(const Target& target, const model::EventTelemetry& event) {
  storage::EventRow row;
  row.robot = *target.record.robot;
  row.kind = model::EventKindText(event.kind);
  row.detail_json = json::DetailText(event.kind);
  row.sampled_at_ms = event.unix_time_ms;
  row.received_at = target.record.received_at;
  events_.push_back({row.received_at, target.entry, std::move(row)});
}

void FakeKinds::WriteMessage(const Target& target, const model::Message& message) {
  const SystemTime at = target.record.received_at;
  messages_.push_back({at, target.entry, {*target.record.robot, message, at}});
}

FakeEntry<storage::OperatorRequestRow>* FakeKinds::OpenRequest(const std::string& ruri,
                                                               const std::string& request_id) {
  const auto open = std::ranges::find_if(requests_, [&](const auto& entry) {
    return entry.row.robot.ruri == ruri && entry.row.request_id == request_id &&
           entry.row.closed_at_ms == 0;
  });
  return open == requests_.end() ? nullptr : &*open;
}

bool FakeKinds::TakesRequest(const CommitRecord& record,
                             const model::OperatorRequest& request) const {
  if (!request.open) return true;
  std::size_t others = 0;
  for (const auto& entry : requests_) {
    if (entry.row.robot.ruri != record.robot->ruri || entry.row.closed_at_ms != 0) continue;
    if (entry.row.request_id == request.request_id) return true;
    ++others;
  }
  return others < storage::kOpenRequestsPerRobotMax;
}

void FakeKinds::WriteRequest(const Target& target, const model::OperatorRequest& request) {
  const model::RobotId& robot = *target.record.robot;
  const SystemTime at = target.record.received_at;
  FakeEntry<storage::OperatorRequestRow>* entry = OpenRequest(robot.ruri, request.request_id);
  if (!request.open) {
    if (entry == nullptr) return;
    entry->row.closed_at_ms = UnixMs(at);
    TrimRequests(robot.ruri);
    return;
  }
  if (entry == nullptr) {
    entry = &requests_.emplace_back(
        FakeEntry<storage::OperatorRequestRow>{at, target.entry, {.opened_at = at}});
  }
  entry->row.robot = robot;
  entry->row.request_id = request.request_id;
  entry->row.kind = request.kind;
  entry->row.text = request.text;
  entry->row.requested_at_ms = request.requested_at_ms;
}

void FakeKinds::TrimRequests(const std::string& ruri) {
  std::vector<std::pair<SystemTime, std::uint64_t>> closed;
  for (const auto& entry : requests_) {
    if (entry.row.robot.ruri != ruri || entry.row.closed_at_ms == 0) continue;
    closed.emplace_back(entry.at, entry.entry);
  }
  if (closed.size() <= storage::kClosedRequestsPerRobotMax) return;
  const auto oldest = *std::ranges::min_element(closed);
  std::erase_if(requests_,
                [&](const auto& entry) { return std::pair(entry.at, entry.entry) == oldest; });
}

void FakeKinds::WriteReport(const Target& target, const model::MissionRunStatus& report) {
  const model::RobotId& robot = *target.record.robot;
  const SystemTime at = target.record.received_at;
  const std::string report_json = json::Text(report);
  reports_.push_back({at,
                      target.entry,
                      {robot, report.mission_id, report.run_id, report.status, report_json, at}});

  const auto [it, begun] = runs_.try_emplace({robot.ruri, report.mission_id, report.run_id});
  Run& run = it->second;
  if (begun) {
    run.at = at;
    run.entry = target.entry;
    run.row.mission_id = report.mission_id;
    run.row.run_id = report.run_id;
    run.row.first_received_at = at;
  }
  run.row.robot = robot;
  if (report.name) run.row.name = *report.name;
  run.row.status = report.status;
  run.row.latest_json = report_json;
  run.row.last_received_at = at;
  ++run.row.updates;
  run.row.closed = storage::RunClosed::kNot;
  run.row.closed_at_ms = 0;
  run.last_entry = target.entry;
  if (run.open()) CloseRunsOver(robot.ruri, at);
}

void FakeKinds::CloseRunsOver(const std::string& ruri, SystemTime at) {
  std::vector<std::pair<std::uint64_t, Run*>> open;
  for (auto it = runs_.lower_bound({ruri, {}, {}});
       it != runs_.end() && std::get<0>(it->first) == ruri; ++it) {
    if (it->second.open()) open.emplace_back(it->second.last_entry, &it->second);
  }
  if (open.size() <= storage::kOpenRunsPerRobotMax) return;
  Run& oldest = *std::ranges::min_element(open)->second;
  oldest.row.closed = storage::RunClosed::kForBound;
  oldest.row.closed_at_ms = UnixMs(at);
  ++runs_closed_;
}

std::size_t FakeKinds::CloseRuns(SystemTime now) {
  const SystemTime until = now - storage::kOpenRunAgeMax;
  std::vector<std::tuple<SystemTime, std::uint64_t, Run*>> old;
  for (auto& [key, run] : runs_) {
    if (!run.open() || run.at >= until || run.row.last_received_at >= until) continue;
    old.emplace_back(run.at, run.entry, &run);
  }
  std::ranges::sort(old);
  old.resize(std::min(old.size(), storage::kSweepRowsMax));
  for (const auto& [at, entry, run] : old) {
    run->row.closed = storage::RunClosed::kForAge;
    run->row.closed_at_ms = UnixMs(now);
  }
  return old.size();
}

void FakeKinds::WriteShape(const Target& target, const model::ShapeOp& shape) {
  const model::RobotId& robot = *target.record.robot;
  if (shape.upsert() == nullptr) {
    shapes_.Delete(robot.ruri, shape.id());
    return;
  }
  const model::ReportedShape& upsert = *shape.upsert();
  storage::ShapeRow row;
  row.robot = robot;
  row.identity = upsert.identity;
  row.area_type = upsert.area_type;
  row.scope = upsert.scope;
  row.geometry_json = json::GeometryText(upsert.data);
  row.expires_at_ms = upsert.expire_time_ms;
  row.min_z_m = upsert.min_z_m;
  row.max_z_m = upsert.max_z_m;
  row.level_id = upsert.level_id;
  row.received_at = target.record.received_at;
  const std::int64_t now_ms = storage::ExpiredByMs(row.received_at, target.rules);
  shapes_.Upsert(shape.id(), {row.received_at, target.entry, std::move(row)}, now_ms);
}

void FakeKinds::WriteObject(const Target& target, const model::ObjectOp& object) {
  const model::RobotId& robot = *target.record.robot;
  if (object.upsert() == nullptr) {
    objects_.Delete(robot.ruri, object.id());
    return;
  }
  const model::Object& upsert = *object.upsert();
  storage::ObjectRow row;
  row.robot = robot;
  row.id = upsert.id;
  row.name = upsert.name;
  row.object_type = upsert.object_type;
  row.scope = upsert.scope;
  row.location_json = json::Text(upsert.location);
  if (upsert.trajectory) row.trajectory_json = json::Text(*upsert.trajectory);
  row.radius_m = upsert.radius_m;
  row.sampled_at_ms = upsert.unix_time_ms;
  row.received_at = target.record.received_at;
  row.expires_at_ms = storage::ExpiryOf(upsert, row.received_at, target.rules);
  const std::int64_t now_ms = storage::ExpiredByMs(row.received_at, target.rules);
  objects_.Upsert(object.id(), {row.received_at, target.entry, std::move(row)}, now_ms);
}

void FakeKinds::WriteLatest(const Target& target, LatestKind kind, std::string body_json) {
  const std::string& ruri = target.record.robot->ruri;
  latest_[{ruri, kind}] = {ruri, kind, std::move(body_json), target.record.received_at};
}

std::size_t FakeKinds::Sweep(SystemTime now) {
  const std::int64_t then = UnixMs(now - storage::kExpiredKept);
  return shapes_.Sweep(then, storage::kSweepRowsMax) + objects_.Sweep(then, storage::kSweepRowsMax);
}

std::size_t FakeKinds::EraseHistory(SystemTime until) {
  std::size_t erased = EraseBefore(events_, until, storage::kRetainRowsMax);
  erased += EraseBefore(messages_, until, storage::kRetainRowsMax);
  erased += EraseBefore(reports_, until, storage::kRetainRowsMax);
  erased += EraseBefore(scope_updates_, until, storage::kRetainRowsMax);
  History<storage::OperatorRequestRow> ended;
  for (const auto& request : requests_) {
    if (request.row.closed_at_ms != 0 && request.row.closed_at_ms < UnixMs(until)) {
      ended.push_back(request);
    }
  }
  const auto gone = OldestBefore(ended, until, storage::kRetainRowsMax);
  erased += std::erase_if(requests_, [&gone](const auto& request) {
    return std::ranges::binary_search(gone, std::pair(request.at, request.entry));
  });
  std::vector<std::tuple<SystemTime, std::uint64_t, RunKey>> closed;
  for (const auto& [key, run] : runs_) {
    if (!run.open() && run.row.last_received_at < until && run.at < until) {
      closed.emplace_back(run.at, run.entry, key);
    }
  }
  std::ranges::sort(closed);
  closed.resize(std::min(closed.size(), storage::kRetainRowsMax));
  for (const auto& [at, entry, key] : closed) runs_.erase(key);
  return erased + closed.size();
}

storage::LatestKindSet FakeKinds::LatestKinds(const std::string& ruri) const {
  storage::LatestKindSet kinds = 0;
  for (auto row = latest_.lower_bound({ruri, LatestKind::kAgentInfo});
       row != latest_.end() && row->first.first == ruri; ++row) {
    kinds |= storage::BitOf(row->first.second);
  }
  return kinds;
}

}  // namespace uplink::testing
