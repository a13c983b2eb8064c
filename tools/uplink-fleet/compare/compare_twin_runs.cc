#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "tools/uplink-fleet/compare/compare_twin_rows.h"

// What a twin's reports of runs and errors must have become.
namespace uplink::synthetic {
namespace {

constexpr const char* kFaultSource = "cyberwave/metrics";

/// How many updates of a run there must be, and may be.
struct UpdateBounds {
  std::int64_t min = 0;
  std::int64_t max = 0;
  bool unknown = false;
};

UpdateBounds BoundsOf(const TwinAccount& account, const SentRun& run) {
  UpdateBounds bounds;
  for (const std::uint64_t number : run.updates) {
    const Delivery delivery = account.DeliveryOf(number);
    if (MustBeThere(delivery)) ++bounds.min;
    if (delivery != Delivery::kOnce) bounds.unknown = true;
    ++bounds.max;
  }
  return bounds;
}

std::optional<double> NumberIn(const google::protobuf::Struct& latest, const char* name) {
  const auto found = latest.fields().find(name);
  if (found == latest.fields().end()) return std::nullopt;
  return found->second.number_value();
}

std::string WhatDiffers(const SentRun& sent, const v1::MissionRun& row) {
  if (row.status() != sent.status) {
    return fmt::format("status {}, not {}", row.status(), sent.status);
  }
  const auto message = row.latest().fields().find("statusMessage");
  const std::string said =
      message == row.latest().fields().end() ? "" : message->second.string_value();
  if (said != sent.message) return fmt::format("message \"{}\", not \"{}\"", said, sent.message);
  const auto differs = [&row](const char* name, const std::optional<std::int64_t>& number) {
    const std::optional<double> found = NumberIn(row.latest(), name);
    return number.has_value() != found.has_value() ||
           (number && static_cast<double>(*number) != *found);
  };
  if (differs("progressX100", sent.progress_x100)) return "another progress";
  if (differs("currentStep", sent.current_step)) return "another step";
  return {};
}

}  // namespace

void CompareTwinRuns(const TwinScript& twin, const StoredTwin& stored, Findings& findings) {
  std::map<std::string, const SentRun*> expected;
  for (const auto& [id, run] : twin.account().runs()) {
    if (BoundsOf(twin.account(), run).min == 0) continue;
    findings.Expect(Thing::kTwinRuns);
    findings.Expect(Thing::kTwinRunUpdates, run.updates.size());
    expected[id] = &run;
  }
  const std::string& ruri = RuriOf(twin, Side::kReal);
  for (const v1::MissionRun& row : stored.Of(Side::kReal).runs) {
    if (!MarkIn(twin.options(), row.run_id())) continue;
    findings.Find(Thing::kTwinRuns);
    findings.Find(Thing::kTwinRunUpdates, static_cast<std::uint64_t>(row.updates()));
    const auto known = expected.find(row.run_id());
    if (known == expected.end()) {
      if (!twin.account().runs().contains(row.run_id())) {
        findings.Differ(Thing::kTwinRuns, ruri, "no such run, or once", row.run_id());
      }
      continue;
    }
    const UpdateBounds bounds = BoundsOf(twin.account(), *known->second);
    if (row.updates() < bounds.min || (row.updates() > bounds.max && !bounds.unknown)) {
      findings.Differ(Thing::kTwinRunUpdates, ruri, fmt::format("{}: {}", row.run_id(), bounds.max),
                      fmt::format("{}", row.updates()));
    }
    const std::string differs = bounds.unknown ? "" : WhatDiffers(*known->second, row);
    if (!differs.empty()) findings.Differ(Thing::kTwinRuns, ruri, row.run_id(), differs);
    expected.erase(known);
  }
  for (const auto& [id, run] : expected) {
    findings.Differ(Thing::kTwinRuns, ruri, id, "no such row");
  }
}

void CompareTwinFaults(const TwinScript& twin, const StoredTwin& stored, Findings& findings) {
  const std::string& ruri = RuriOf(twin, Side::kReal);
  std::map<std::pair<std::string, bool>, std::size_t> counts;
  for (const v1::Fault& row : stored.Of(Side::kReal).faults) {
    if (!MarkIn(twin.options(), row.fault_id())) continue;
    findings.Find(Thing::kTwinFaults);
    ++counts[{row.fault_id(), row.active()}];
    const bool described = !row.active() || row.description() == row.fault_id();
    if (row.source() == kFaultSource && described) continue;
    findings.Differ(Thing::kTwinFaults, ruri, fmt::format("{} of {}", row.fault_id(), kFaultSource),
                    fmt::format("source {}, description {}", row.source(), row.description()));
  }
  std::map<std::string, bool> active;
  bool unknown = false;
  for (const auto& [number, changes] : twin.account().fault_changes()) {
    const Delivery delivery = twin.account().DeliveryOf(number);
    unknown = unknown || delivery != Delivery::kOnce;
    for (const SentFaultChange& change : changes) {
      active[change.fault_id] = change.active;
      if (MustBeThere(delivery)) findings.Expect(Thing::kTwinFaults);
      const std::string wrong = WrongCount(delivery, counts[{change.fault_id, change.active}]);
      if (wrong.empty()) continue;
      findings.Differ(
          Thing::kTwinFaults, ruri,
          fmt::format("{} {} once", change.fault_id, change.active ? "raised" : "cleared"), wrong);
    }
  }
  if (unknown) return;  // what was raised last is not known either
  for (const auto& [id, raised] : active) findings.Expect(Thing::kTwinActiveFaults, raised ? 1 : 0);
  for (const v1::Fault& row : stored.Of(Side::kReal).active_faults) {
    if (!MarkIn(twin.options(), row.fault_id())) continue;
    findings.Find(Thing::kTwinActiveFaults);
    const auto known = active.find(row.fault_id());
    if (known == active.end() || !known->second) {
      findings.Differ(Thing::kTwinActiveFaults, ruri, row.fault_id() + " is cleared", "active");
    } else {
      active.erase(known);
    }
  }
  for (const auto& [id, raised] : active) {
    if (raised) findings.Differ(Thing::kTwinActiveFaults, ruri, id + " is active", "not active");
  }
}

}  // namespace uplink::synthetic
