#include "tools/uplink-fleet/compare/compare_twin_rows.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <boost/json.hpp>
#include <fmt/core.h>
#include <google/protobuf/util/json_util.h>

#include "schema/json/exact.h"
#include "schema/model/rejection.h"
#include "server/view/timestamps.h"
#include "tools/uplink-fleet/robot/rows.h"

namespace uplink::synthetic {
namespace {

namespace js = boost::json;
using google::protobuf::Struct;

constexpr const char* kSource = "cyberwave";
constexpr const char* kFaultSource = "cyberwave/metrics";
constexpr const char* kOnlyWrong = "only what is wrong on purpose";

js::object ObjectOf(const Struct& detail) {
  std::string text;
  if (!google::protobuf::util::MessageToJsonString(detail, &text).ok()) return {};
  std::optional<js::value> value = json::ParseExact(text);
  return value && value->is_object() ? value->get_object() : js::object();
}

std::string ContentOf(const v1::Event& row) {
  return EventContent(row.kind(), ObjectOf(row.detail()), view::UnixMs(row.sampled_at()));
}
std::string ContentOf(const v1::RobotMessage& row) {
  return MessageContent(row.level(), row.message(), ObjectOf(row.detail()),
                        view::UnixMs(row.sampled_at()));
}
std::string ContentOf(const v1::ScopeUpdate& row) {
  return ScopeContent(row.scope(), row.id(), row.type(), ObjectOf(row.detail()),
                      view::UnixMs(row.sampled_at()));
}

std::string RunText(std::string_view status, std::string_view message,
                    std::optional<double> progress_x100, std::optional<double> step) {
  constexpr double kNone = -1;
  return fmt::format("{} \"{}\", progress {}, step {}", status, message,
                     progress_x100.value_or(kNone), step.value_or(kNone));
}
std::string TextOf(const SentRun& run) {
  return RunText(run.status, run.message, run.progress_x100, run.current_step);
}
std::string TextOf(const v1::MissionRun& row) {
  const auto& fields = row.latest().fields();
  const auto number = [&fields](const char* name) {
    const auto found = fields.find(name);
    return found == fields.end() ? std::nullopt : std::optional(found->second.number_value());
  };
  const auto said = fields.find("statusMessage");
  return RunText(row.status(), said == fields.end() ? "" : said->second.string_value(),
                 number("progressX100"), number("currentStep"));
}

std::string TextOf(const v1::Quarantined& row, bool of_no_robot) {
  return fmt::format("{} on {}, {} bytes, source {}{}", row.reason(), row.topic(),
                     row.payload_bytes(), row.source(), of_no_robot ? ", of no robot" : "");
}
std::string TextOf(const SentWrong& wrong) {
  v1::Quarantined row;
  row.set_reason(std::string(model::ToText(wrong.reason)));
  row.set_topic(wrong.topic);
  row.set_payload_bytes(static_cast<std::int64_t>(wrong.bytes));
  row.set_source(kSource);
  return TextOf(row, wrong.of_no_robot);
}

/// The server keeps the payload of one rejection per second and reason.
bool IsThinned(const v1::Quarantined& row) {
  return row.payload().empty() && row.payload_bytes() > 0;
}

/// One twin's account against its rows. Confined to one comparison.
class TwinRows final {
 public:
  TwinRows(const TwinScript& twin, const StoredTwin& stored, Findings& findings)
      : twin_(twin), real_(stored.Of(Side::kReal)), findings_(findings) {}

  template <typename Row>
  void Contents(Thing thing, RowKind kind, Side side, const std::vector<Row>& rows) {
    RowSet set(thing, twin_.ids().RuriOf(side), findings_);
    for (const auto& [number, row] : twin_.account().rows()) {
      if (row.kind != kind || row.side != side) continue;
      set.Expect(std::to_string(number), {.content = row.content,
                                          .shown = fmt::format("number {}, {}", number, row.type),
                                          .times = TimesOf(number)});
    }
    for (const Row& row : rows) {
      const std::string content = ContentOf(row);
      const std::optional<std::uint64_t> number = MarkIn(twin_.options(), content);
      if (!number) continue;
      set.Find(std::to_string(*number), HashOf(content), [&content] {
        constexpr std::size_t kShownBytes = 200;
        return content.substr(0, kShownBytes);
      });
    }
    set.Finish();
  }

  void Runs() {
    RowSet set = SetOf(Thing::kTwinRuns);
    for (const auto& [id, run] : twin_.account().runs()) {
      const Times updates = UpdatesOf(run);
      set.Expect(id, {.content = updates.max == kAnyTimes ? 0 : HashOf(TextOf(run)),
                      .shown = fmt::format("{}: {}", id, TextOf(run)),
                      .times = {.min = updates.min > 0 ? 1U : 0U, .max = 1}});
      if (updates.min > 0) findings_.Expect(Thing::kTwinRunUpdates, run.updates.size());
    }
    for (const v1::MissionRun& row : real_.runs) {
      if (!MarkIn(twin_.options(), row.run_id())) continue;
      const auto found = static_cast<std::uint64_t>(row.updates());
      findings_.Find(Thing::kTwinRunUpdates, found);
      if (!set.Find(row.run_id(), HashOf(TextOf(row)), [&row] { return TextOf(row); })) continue;
      const Times updates = UpdatesOf(twin_.account().runs().at(row.run_id()));
      if (found >= updates.min && found <= updates.max) continue;
      Differ(Thing::kTwinRunUpdates, fmt::format("{}: {}", row.run_id(), updates.max),
             fmt::format("{}", found));
    }
    set.Finish();
  }

  /// Raised and cleared once for each error.
  void Faults() {
    RowSet set = SetOf(Thing::kTwinFaults);
    std::map<std::string, bool> active;
    bool unknown = false;
    for (const auto& [number, changes] : twin_.account().fault_changes()) {
      unknown = unknown || twin_.account().DeliveryOf(number) != Delivery::kOnce;
      for (const SentFaultChange& change : changes) {
        active[change.fault_id] = change.active;
        const std::string key = FaultKey(change.fault_id, change.active);
        const std::string described = change.active ? change.fault_id : "";
        set.Expect(key, {.content = HashOf(kFaultSource + described),
                         .shown = fmt::format("{} of {}", key, kFaultSource),
                         .times = TimesOf(number)});
      }
    }
    for (const v1::Fault& row : real_.faults) {
      if (!MarkIn(twin_.options(), row.fault_id())) continue;
      const std::string described = row.active() ? row.description() : "";
      set.Find(FaultKey(row.fault_id(), row.active()), HashOf(row.source() + described),
               [&row] { return Shown(row); });
    }
    set.Finish();
    if (!unknown) ActiveFaults(active);  // else what was raised last is not known either
  }

  void Quarantine(std::vector<v1::Quarantined>& no_robot) {
    RowSet set = SetOf(Thing::kTwinQuarantine);
    for (const auto& [number, wrong] : twin_.account().wrongs()) {
      set.Expect(std::to_string(number),
                 {.content = HashOf(TextOf(wrong)),
                  .shown = fmt::format("number {}: {}", number, TextOf(wrong)),
                  .times = TimesOf(number)});
    }
    for (const v1::Quarantined& row : real_.quarantine) FindWrong(row, false, set);
    for (const v1::Quarantined& row : no_robot) FindWrong(row, true, set);
    FindThinned(no_robot, set);
    set.Finish(static_cast<std::uint64_t>(real_.quarantine_dropped));
  }

 private:
  [[nodiscard]] RowSet SetOf(Thing thing) { return {thing, twin_.ids().ruri, findings_}; }
  void Differ(Thing thing, std::string expected, std::string found) {
    findings_.Differ(thing, twin_.ids().ruri, std::move(expected), std::move(found));
  }
  [[nodiscard]] Times TimesOf(std::uint64_t number) const {
    return synthetic::TimesOf(twin_.account().DeliveryOf(number));
  }

  /// How many updates of a run there must be, and may be.
  [[nodiscard]] Times UpdatesOf(const SentRun& run) const {
    Times times{.min = 0, .max = run.updates.size()};
    for (const std::uint64_t number : run.updates) {
      times.min += TimesOf(number).min;
      if (twin_.account().DeliveryOf(number) != Delivery::kOnce) times.max = kAnyTimes;
    }
    return times;
  }

  static std::string FaultKey(const std::string& id, bool active) {
    return id + (active ? " raised" : " cleared");
  }

  void ActiveFaults(const std::map<std::string, bool>& active) {
    RowSet set = SetOf(Thing::kTwinActiveFaults);
    for (const auto& [id, raised] : active) {
      if (raised) set.Expect(id, {.shown = id});
    }
    for (const v1::Fault& row : real_.active_faults) {
      if (!MarkIn(twin_.options(), row.fault_id())) continue;
      set.Find(row.fault_id(), 0, [&row] { return Shown(row); });
    }
    set.Finish();
  }

  /// The number of the twin's empty message, which has no mark, if it may be this one.
  [[nodiscard]] std::optional<std::uint64_t> EmptyIn(const v1::Quarantined& row) const {
    if (row.payload_bytes() != 0) return std::nullopt;
    for (const auto& [number, wrong] : twin_.account().wrongs()) {
      if (wrong.bytes == 0 && wrong.topic == row.topic()) return number;
    }
    return std::nullopt;
  }

  /// A row of the twin's own robot, or one that belongs to no robot.
  void FindWrong(const v1::Quarantined& row, bool of_no_robot, RowSet& set) {
    if (IsThinned(row)) return;
    std::optional<std::uint64_t> number = MarkIn(twin_.options(), row.payload());
    if (!number && !of_no_robot) number = EmptyIn(row);
    std::string text = TextOf(row, of_no_robot);
    if (number) {
      set.Find(std::to_string(*number), HashOf(text), [&text] { return std::move(text); });
      return;
    }
    // Rows of no robot come from all twins; one with a mark of another run belongs to that run.
    const bool foreign = of_no_robot || row.payload().find('~') != std::string::npos;
    if (!foreign) Differ(Thing::kTwinQuarantine, kOnlyWrong, text);
  }

  /// Rows whose payload the server dropped have no mark: each stands for one message that is still
  /// missing and that it describes. Those of no robot are taken out, since another twin may lack
  /// one like it; one of the robot's own that nothing lacks is reported.
  void FindThinned(std::vector<v1::Quarantined>& no_robot, RowSet& set) {
    std::vector<v1::Quarantined> own = real_.quarantine;
    std::erase_if(own, [](const v1::Quarantined& row) { return !IsThinned(row); });
    for (const auto& [number, wrong] : twin_.account().wrongs()) {
      const std::string key = std::to_string(number);
      if (set.Found(key)) continue;
      std::vector<v1::Quarantined>& rows = wrong.of_no_robot ? no_robot : own;
      std::string text = TextOf(wrong);
      const auto row =
          std::ranges::find_if(rows, [&text, &wrong = wrong](const v1::Quarantined& each) {
            return IsThinned(each) && TextOf(each, wrong.of_no_robot) == text;
          });
      if (row == rows.end()) continue;
      set.Find(key, HashOf(text), [&text] { return std::move(text); });
      rows.erase(row);
    }
    for (const v1::Quarantined& row : own) {
      Differ(Thing::kTwinQuarantine, kOnlyWrong, TextOf(row, false));
    }
  }

  const TwinScript& twin_;
  /// All that is wrong, run or raised is of the real robot.
  const StoredRobot& real_;
  Findings& findings_;
};

}  // namespace

Times TimesOf(Delivery delivery) {
  switch (delivery) {
    case Delivery::kOnce:
      return {.min = 1, .max = 1};
    case Delivery::kOnceOrMore:
      return {.min = 1, .max = kAnyTimes};
    case Delivery::kAtMostOnce:
      return {.min = 0, .max = 1};
    case Delivery::kUnknown:
      break;
  }
  return {.min = 0, .max = kAnyTimes};
}

void CompareTwinRows(const TwinScript& twin, const StoredTwin& stored,
                     std::vector<v1::Quarantined>& no_robot, Findings& findings) {
  TwinRows rows(twin, stored, findings);
  for (const Side side : {Side::kReal, Side::kSim}) {
    rows.Contents(Thing::kTwinEvents, RowKind::kEvent, side, stored.Of(side).events);
    rows.Contents(Thing::kTwinMessages, RowKind::kMessage, side, stored.Of(side).messages);
  }
  rows.Contents(Thing::kTwinScopes, RowKind::kScope, Side::kReal, stored.scopes);
  rows.Runs();
  rows.Faults();
  rows.Quarantine(no_robot);
  for (const v1::Quarantined& row : stored.Of(Side::kSim).quarantine) {
    findings.Differ(Thing::kTwinQuarantine, twin.ids().sim_ruri, "nothing of it is wrong",
                    TextOf(row, false));
  }
}

}  // namespace uplink::synthetic
