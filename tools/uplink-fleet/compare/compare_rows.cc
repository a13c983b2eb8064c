#include "tools/uplink-fleet/compare/compare_rows.h"

#include <cstdint>
#include <limits>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "schema/model/enum_text.h"
#include "server/view/timestamps.h"
#include "tools/uplink-fleet/compare/row_set.h"
#include "tools/uplink-fleet/robot/rows.h"
#include "tools/uplink-fleet/robot/script.h"

namespace uplink::synthetic {
namespace {

/// When the report arrived that made the fault active: the first raise since it was last clear.
std::int64_t RaisedAt(const std::vector<v1::Fault>& newest_first, const v1::Fault& fault) {
  std::int64_t raised_ms = 0;
  for (const v1::Fault& row : newest_first) {
    if (row.fault_id() != fault.fault_id() || row.source() != fault.source()) continue;
    if (!row.active()) break;
    raised_ms = view::UnixMs(row.received_at());
  }
  return raised_ms;
}

std::string TextOf(std::string_view reason, std::string_view field) {
  return fmt::format("{} \"{}\"", reason, field);
}

/// One robot's account against its rows. Confined to one comparison.
class RobotRows final {
 public:
  RobotRows(const RobotOutcome& robot, const StoredRobot& stored, const std::string& run,
            Findings& findings)
      : robot_(robot), stored_(stored), run_(run), findings_(findings) {}

  /// A history, one row per message: as many of each content as were sent.
  template <typename Row>
  void History(Thing thing, model::Variant variant, const std::vector<Row>& rows) {
    RowSet set = SetOf(thing);
    for (const SentMessage& message : robot_.account.sent()) {
      if (message.variant != variant || message.row_hash == 0) continue;
      set.Expect(std::to_string(message.row_hash),
                 {.shown = fmt::format("number {}", message.seq),
                  .times = {.min = message.acked ? 1U : 0U, .max = 1}});
    }
    std::int64_t received_before = 0;
    for (const Row& row : rows) {
      if (row.ruri() != robot_.ruri) Differ(thing, "rows of this robot", Shown(row));
      if (received_before != 0 && view::UnixMs(row.received_at()) > received_before) {
        Differ(thing, "the newest first", Shown(row));
      }
      received_before = view::UnixMs(row.received_at());
      set.Find(std::to_string(HashOf(Bare(row))), 0, [&row] { return Shown(row); });
    }
    set.Finish();
  }

  /// Shapes or objects: those that the robot left present and that had not expired when they were
  /// read.
  template <typename Row>
  void Present(Thing thing, const std::map<std::string, Row>& expected,
               const std::vector<Row>& rows) {
    RowSet set = SetOf(thing);
    for (const auto& [id, row] : expected) {
      const std::int64_t expires_ms =
          view::UnixMs(row.expires_at()) == 0 ? kNever : view::UnixMs(row.expires_at());
      set.Expect(id, {.content = HashOf(row),
                      .shown = Shown(row),
                      .times = {.min = expires_ms > stored_.read.to_ms ? 1U : 0U,
                                .max = expires_ms > stored_.read.from_ms ? 1U : 0U}});
    }
    for (const Row& row : rows) {
      // Some ids are those of several robots; all begin with the run.
      if (!row.id().starts_with(run_ + "-")) continue;
      Row bare = Bare(row);
      // One that names no expiry lives as long as the server lets it.
      const auto known = expected.find(row.id());
      if (known != expected.end() && view::UnixMs(known->second.expires_at()) == 0) {
        bare.clear_expires_at();
      }
      set.Find(row.id(), HashOf(bare), [&row] { return Shown(row); });
    }
    set.Finish();
  }

  /// The raises that the robot has not cleared, and when each was raised.
  void ActiveFaults() {
    RowSet set = SetOf(Thing::kActiveFaults);
    for (const auto& [key, fault] : robot_.account.active()) {
      v1::Fault row = fault;
      view::SetTimeMs(row, &v1::Fault::mutable_raised_at, RaisedAt(stored_.faults, fault));
      set.Expect(key.first, {.content = HashOf(row), .shown = Shown(row)});
    }
    for (const v1::Fault& stored : stored_.active_faults) {
      if (stored.source() != SourceOf(run_)) continue;
      v1::Fault row = Bare(stored);
      view::SetTimeMs(row, &v1::Fault::mutable_raised_at, view::UnixMs(stored.raised_at()));
      set.Find(stored.fault_id(), HashOf(row), [&stored] { return Shown(stored); });
    }
    set.Finish();
  }

  /// What the reports of each mission run must have become.
  void MissionRuns() {
    RowSet set = SetOf(Thing::kMissionRuns);
    for (const auto& [key, run] : robot_.account.runs()) {
      v1::MissionRun row;
      row.set_status(model::EnumText(run.latest.status));
      row.set_name(run.name);
      *row.mutable_latest() = PartOf(run.latest);
      set.Expect(RunKey(key.first, key.second),
                 {.content = HashOf(row), .shown = key.second + ": " + Shown(row)});
      findings_.Expect(Thing::kMissionUpdates, run.updates);
    }
    for (const v1::MissionRun& stored : stored_.runs) {
      if (!stored.run_id().starts_with(robot_.mark + "-")) continue;
      v1::MissionRun row;
      row.set_status(stored.status());
      row.set_name(stored.name());
      *row.mutable_latest() = stored.latest();
      findings_.Find(Thing::kMissionUpdates, static_cast<std::uint64_t>(stored.updates()));
      if (!set.Find(RunKey(stored.mission_id(), stored.run_id()), HashOf(row),
                    [&stored] { return Shown(stored); })) {
        continue;
      }
      CompareRun(robot_.account.runs().at({stored.mission_id(), stored.run_id()}), stored);
    }
    set.Finish();
  }

  /// The quarantine of this session against the messages that were wrong on purpose: each acked one
  /// has its row, and its Reject came before the Ack.
  void Quarantine() {
    RowSet set = SetOf(Thing::kQuarantine);
    RowSet told = SetOf(Thing::kToldBeforeAck);
    for (const auto& [tag, wrong] : robot_.account.wrongs()) {
      if (!wrong.acked) continue;
      const std::string key = std::to_string(wrong.seq);
      const std::string must = TextOf(model::ToText(wrong.reason), wrong.field);
      const ExpectedRow row{.content = HashOf(must),
                            .shown = fmt::format("number {}: {}", wrong.seq, must)};
      set.Expect(key, row);
      told.Expect(key, row);
      if (!wrong.told) continue;
      std::string text = TextOf(model::ToText(wrong.told->reason), wrong.told->field);
      told.Find(key, HashOf(text), [&text] { return std::move(text); });
    }
    told.Finish();
    for (const v1::Quarantined& row : stored_.quarantine) {
      const std::string key = std::to_string(row.seq());
      if (row.session_id() != robot_.session_hex) continue;
      // What is not acked may have been wrong, too.
      if (!robot_.all_settled && !set.Expects(key)) continue;
      const std::string text = TextOf(row.reason(), row.field());
      set.Find(key, HashOf(text), [&] { return fmt::format("number {}: {}", key, text); });
    }
    set.Finish(static_cast<std::uint64_t>(stored_.quarantine_dropped));
  }

  /// What must not be there at all.
  void Wrong() {
    for (const v1::Gap& gap : stored_.gaps) {
      if (gap.session_id() != robot_.session_hex) continue;
      findings_.Find(Thing::kGaps);
      Differ(Thing::kGaps, "none", fmt::format("{} to {}", gap.first_seq(), gap.last_seq()));
    }
    if (robot_.account.good_rejected() != 0) {
      findings_.Find(Thing::kGoodRejected, robot_.account.good_rejected());
      Differ(Thing::kGoodRejected, "0", robot_.account.first_good_rejection());
    }
  }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

  [[nodiscard]] RowSet SetOf(Thing thing) { return {thing, robot_.ruri, findings_}; }
  void Differ(Thing thing, std::string expected, std::string found) {
    findings_.Differ(thing, robot_.ruri, std::move(expected), std::move(found));
  }

  static std::string RunKey(const std::string& mission_id, const std::string& run_id) {
    return run_id + " of " + mission_id;
  }

  void CompareRun(const RunExpectation& expected, const v1::MissionRun& row) {
    if (row.updates() != static_cast<std::int64_t>(expected.updates)) {
      Differ(Thing::kMissionUpdates, fmt::format("{}: {}", row.run_id(), expected.updates),
             fmt::format("{}", row.updates()));
    }
    if (view::UnixMs(row.first_received_at()) != 0 &&
        view::UnixMs(row.first_received_at()) <= view::UnixMs(row.last_received_at())) {
      return;
    }
    Differ(Thing::kMissionRuns, row.run_id() + ": the last arrival after the first",
           fmt::format("{}, {}", view::UnixMs(row.last_received_at()),
                       view::UnixMs(row.first_received_at())));
  }

  const RobotOutcome& robot_;
  const StoredRobot& stored_;
  const std::string& run_;
  Findings& findings_;
};

}  // namespace

void CompareRows(const RobotOutcome& robot, const StoredRobot& stored, const std::string& run,
                 Findings& findings) {
  std::vector<v1::Fault> faults;
  for (const v1::Fault& row : stored.faults) {
    if (row.source() == SourceOf(run)) faults.push_back(row);
  }
  RobotRows rows(robot, stored, run, findings);
  rows.History(Thing::kFaultReports, model::Variant::kFault, faults);
  rows.History(Thing::kEvents, model::Variant::kEventTelemetry, stored.events);
  rows.History(Thing::kMessages, model::Variant::kMessage, stored.messages);
  rows.ActiveFaults();
  rows.MissionRuns();
  rows.Present(Thing::kShapes, robot.account.shapes(), stored.shapes);
  rows.Present(Thing::kObjects, robot.account.objects(), stored.objects);
  rows.Quarantine();
  rows.Wrong();
}

}  // namespace uplink::synthetic
