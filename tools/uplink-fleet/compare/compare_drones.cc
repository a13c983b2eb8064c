#include "tools/uplink-fleet/compare/compare_drones.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <boost/json.hpp>
#include <fmt/core.h>
#include <google/protobuf/util/json_util.h>

#include "schema/json/exact.h"
#include "server/view/timestamps.h"
#include "tools/uplink-fleet/compare/compare_live.h"
#include "tools/uplink-fleet/compare/row_set.h"
#include "tools/uplink-fleet/robot/rows.h"
#include "tools/uplink-fleet/twin/account.h"
#include "tools/uplink-fleet/twin/canonical.h"

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

constexpr const char* kArrival = "receivedAt";
/// Bytes of a value that are shown of a difference.
constexpr std::size_t kShownBytes = 200;

std::string TextIn(const js::object& object, const char* name) {
  const js::value* value = object.if_contains(name);
  if (value == nullptr) return "none";
  return value->is_string() ? std::string(value->get_string()) : js::serialize(*value);
}

js::object ObjectOf(std::string_view text) {
  std::optional<js::value> value = json::ParseExact(text);
  return value && value->is_object() ? value->get_object() : js::object();
}

js::object ObjectOf(const google::protobuf::Struct& detail) {
  std::string text;
  if (!google::protobuf::util::MessageToJsonString(detail, &text).ok()) return {};
  return ObjectOf(text);
}

/// `Robot.uncrew` by the paths of the account: a type's name, `NAME/KEY` where it has parts.
std::map<std::string, std::string> PartsOf(const js::object& uncrew) {
  std::map<std::string, std::string> parts;
  const auto add = [&parts](const std::string& path, const js::value& value) {
    js::object part = value.is_object() ? value.get_object() : js::object{{"not", "an object"}};
    part.erase(kArrival);
    parts[path] = CanonicalText(part);
  };
  for (const auto& type : uncrew) {
    const std::string name(type.key());
    const js::object* within = type.value().if_object();
    if (within == nullptr || within->contains(kArrival)) {
      add(name, type.value());
      continue;
    }
    for (const auto& part : *within) add(name + "/" + std::string(part.key()), part.value());
  }
  return parts;
}

std::string ContentOf(const v1::Event& row) {
  return EventContent(row.kind(), ObjectOf(row.detail()), view::UnixMs(row.sampled_at()));
}
std::string ContentOf(const v1::RobotMessage& row) {
  js::object detail = ObjectOf(row.detail());
  if (row.has_source_level()) detail["sourceLevel"] = row.source_level();
  return MessageContent(row.level(), row.message(), detail, view::UnixMs(row.sampled_at()));
}
std::string ContentOf(const v1::Fault& row) {
  return FaultContent({.id = row.fault_id(),
                       .active = row.active(),
                       .source = row.source(),
                       .severity = row.severity(),
                       .category = row.category(),
                       .description = row.description(),
                       .sampled_ms = view::UnixMs(row.sampled_at())});
}
std::string ContentOf(const v1::Quarantined& row) {
  return QuarantineContent(row.reason(), row.field(), row.payload_bytes(), row.source(),
                           row.topic());
}

std::string KeyOf(const v1::Event& row) {
  return fmt::format("{} {}", row.kind(), view::UnixMs(row.sampled_at()));
}
std::string KeyOf(const v1::RobotMessage& row) {
  return fmt::format(" {}", view::UnixMs(row.sampled_at()));
}
std::string KeyOf(const v1::Fault& row) { return FaultKey(row.fault_id(), row.active()); }
std::string KeyOf(const v1::Quarantined& row) { return ContentOf(row); }

std::string OpenText(const std::string& content, bool open) {
  return content + (open ? ", open" : ", closed");
}
std::string ContentOf(const v1::OperatorRequest& row) {
  return OpenText(RequestContent(row.kind(), row.text(), view::UnixMs(row.requested_at())),
                  view::UnixMs(row.closed_at()) == 0);
}

/// One drone's account against its rows. Confined to one comparison.
class DroneRows final {
 public:
  DroneRows(const DroneScript& drone, Findings& findings)
      : account_(drone.account()),
        ruri_(DroneRuri(drone.options().index)),
        mark_(drone.options().run + "."),
        findings_(findings) {}

  template <typename Row>
  void List(Thing thing, DroneList list, const std::vector<Row>& rows, std::uint64_t dropped = 0) {
    RowSet set(thing, ruri_, findings_);
    for (const auto& [number, row] : account_.rows()) {
      if (row.list != list) continue;
      const bool sure = row.sure && !account_.Waits(number);
      set.Expect(row.key, {.content = row.content.empty() ? 0 : HashOf(row.content),
                           .shown = row.content.empty() ? row.key : row.content,
                           .times = {.min = sure ? 1U : 0U, .max = 1}});
    }
    for (const Row& row : rows) {
      if (!IsOfRun(row)) continue;
      const std::string content = ContentOf(row);
      set.Find(KeyOf(row), HashOf(content), [&content] { return content.substr(0, kShownBytes); });
    }
    set.Finish(dropped);
  }

  void ActiveFaults(const std::vector<v1::Fault>& rows) {
    RowSet set(Thing::kDroneActiveFaults, ruri_, findings_);
    for (const std::string& id : account_.active()) set.Expect(id, {.shown = id});
    for (const v1::Fault& row : rows) {
      if (IsOfRun(row)) set.Find(row.fault_id(), 0, [&row] { return row.fault_id(); });
    }
    set.Finish();
  }

  void Requests(const std::vector<v1::OperatorRequest>& rows) {
    RowSet set(Thing::kDroneRequests, ruri_, findings_);
    for (const auto& [id, request] : account_.requests()) {
      const std::string content = OpenText(request.content, request.closed == 0);
      const bool known = !account_.Waits(request.closed);
      set.Expect(id, {.content = known ? HashOf(content) : 0,
                      .shown = content,
                      .times = {.min = account_.Waits(request.opened) ? 0U : 1U, .max = 1}});
    }
    for (const v1::OperatorRequest& row : rows) {
      if (!row.request_id().starts_with(mark_)) continue;
      std::string content = ContentOf(row);
      set.Find(row.request_id(), HashOf(content), [&content] { return content; });
    }
    set.Finish();
  }

 private:
  /// Of faults also those of earlier runs are listed, which the first sets of this one ended.
  [[nodiscard]] bool IsOfRun(const v1::Fault& row) const {
    return row.fault_id().starts_with(mark_);
  }
  template <typename Row>
  [[nodiscard]] bool IsOfRun(const Row& /*row*/) const {
    return true;
  }

  const DroneAccount& account_;
  const std::string ruri_;
  const std::string mark_;
  Findings& findings_;
};

}  // namespace

void CompareDroneLive(const DroneScript& drone, const std::string& look, Findings& findings) {
  const DroneAccount& account = drone.account();
  const std::string ruri = DroneRuri(drone.options().index);
  const js::object robot = ObjectOf(look);
  const std::string shown =
      fmt::format("{}, source {}", TextIn(robot, "presence"), TextIn(robot, "source"));
  findings.Check(Thing::kDroneOnline, ruri, shown == "online, source uncrew",
                 "online, source uncrew", shown);
  const auto open = std::ranges::count_if(
      account.requests(), [](const auto& request) { return request.second.closed == 0; });
  const std::string count = TextIn(robot, "operatorRequestsOpen");
  findings.Check(Thing::kDroneRequestsOpen, ruri, count == std::to_string(open),
                 std::to_string(open), count);
  const js::value* said = robot.if_contains("uncrew");
  RowSet parts(Thing::kDroneLive, ruri, findings);
  const auto cut = [](const std::string& path, const std::string& text) {
    return (path + ": " + text).substr(0, kShownBytes);
  };
  for (const auto& [path, text] : account.live()) {
    parts.Expect(path, {.content = HashOf(text), .shown = cut(path, text)});
  }
  if (said != nullptr && said->is_object()) {
    for (const auto& [path, text] : PartsOf(said->get_object())) {
      parts.Find(path, HashOf(text), [&, path = path, text = text] { return cut(path, text); });
    }
  }
  parts.Finish();
}

void CompareDroneRows(const DroneScript& drone, const StoredDrone& stored, Findings& findings) {
  const DroneAccount& account = drone.account();
  findings.Check(Thing::kDroneAnswers, DroneRuri(drone.options().index),
                 account.undue_answers() == 0, account.first_due(),
                 fmt::format("{}; {} such in all", account.first_undue(), account.undue_answers()));
  DroneRows rows(drone, findings);
  rows.List(Thing::kDroneMessages, DroneList::kMessages, stored.robot.messages);
  rows.List(Thing::kDroneEvents, DroneList::kEvents, stored.robot.events);
  rows.List(Thing::kDroneFaults, DroneList::kFaults, stored.robot.faults);
  rows.List(Thing::kDroneQuarantine, DroneList::kQuarantine, stored.robot.quarantine,
            static_cast<std::uint64_t>(stored.robot.quarantine_dropped));
  // Else what was said last is not known.
  if (account.waiting() == 0) rows.ActiveFaults(stored.robot.active_faults);
  rows.Requests(stored.requests);
}

void CompareDronePresence(const DroneScript& drone, const StoredDrone& stored, const Span& run,
                          Findings& findings) {
  const std::chrono::microseconds silence(drone.account().longest_silence_us());
  const std::string wrong =
      WrongPresence(stored.robot.presence, run, silence > kDroneSilence ? kAnyTimes : 0);
  findings.Check(Thing::kDronePresence, DroneRuri(drone.options().index), wrong.empty(),
                 "online at last, never offline", wrong);
}

}  // namespace uplink::synthetic
