#include "tools/uplink-fleet/robot/behaviour/missions.h"

#include <array>
#include <string_view>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

using enum model::MissionStatus;

struct Plan {
  std::string_view id;
  std::string_view name;
};
/// The last is the robot's own: it has no id.
constexpr std::array<Plan, 5> kPlans = {{{"mow-north", "Mow the north field"},
                                         {"mow-south", "Mow the south field"},
                                         {"edges", "Trim the edges"},
                                         {"inspect", "Inspect the fence"},
                                         {"", "Look for the base"}}};
constexpr std::uint16_t kWholeX100 = 10'000;
constexpr double kPauseBetweenS = 4;

}  // namespace

void Missions::Report(const Moment& moment, model::MissionStatus status, Outbox& out) {
  report_.unix_time_ms = moment.now_ms;
  report_.status = status;
  out.emplace_back(report_);
}

void Missions::Tell(const Moment& moment, model::MessageLevel level, const std::string& what,
                    Outbox& out) const {
  out.emplace_back(model::Message{.unix_time_ms = moment.now_ms,
                                  .level = level,
                                  .message = fmt::format("{}: {}", *report_.name, what)});
}

void Missions::Advance(const Moment& moment, Facts& facts, const Route& route, Outbox& out) {
  if (facts.mission_active && !facts.may_drive()) {
    if (report_.status == kRunning) {
      report_.status_message = facts.estop ? "emergency stop" : "charging";
      Report(moment, kPaused, out);
    }
    return;
  }
  if (report_.status == kPaused) {
    report_.status_message.reset();
    Report(moment, kRunning, out);
  }
  left_s_ -= moment.dt_s;
  if (left_s_ > 0) return;
  if (facts.mission_active) {
    Step(moment, facts, route, out);
  } else if (late_report_) {
    late_report_ = false;
    left_s_ = 1;
    report_.status_message = "the log of the run is uploaded";
    Report(moment, report_.status, out);
  } else {
    Begin(moment, facts, out);
  }
}

void Missions::Begin(const Moment& moment, Facts& facts, Outbox& out) {
  const Plan& plan = kPlans.at(random_.Below(kPlans.size()));
  report_ = {};
  report_.mission_id = plan.id;
  report_.run_id = fmt::format("{}-run-{}", mark_, ++runs_);
  report_.name = plan.name;
  report_.progress_x100 = std::uint16_t{0};
  report_.current_step = 0;
  report_.total_steps = static_cast<std::uint32_t>(4 + random_.Below(6));
  Report(moment, kReady, out);
  report_.time_started_ms = moment.now_ms;
  report_.expected_end_time_ms = moment.now_ms + std::int64_t{2000} * *report_.total_steps;
  Report(moment, kStarting, out);
  if (!report_.mission_id.empty()) {
    out.emplace_back(
        model::EventTelemetry{moment.now_ms, model::MissionStartedEvent{report_.mission_id}});
  }
  facts.mission_active = true;
  facts.mission_name = plan.name;
  left_s_ = 1;
}

void Missions::Step(const Moment& moment, Facts& facts, const Route& route, Outbox& out) {
  const std::uint32_t steps = *report_.total_steps;
  const std::uint32_t step = *report_.current_step + 1;
  if (step > steps || (step * 2 > steps && random_.Chance(0.03))) {
    return End(moment, facts, out);
  }
  report_.current_step = step;
  report_.progress_x100 = static_cast<std::uint16_t>(kWholeX100 * step / (steps + 1));
  report_.current_path_id = fmt::format("path-{}", step);
  const model::GeoPoint2 target = route.Ahead().front();
  report_.current_target = model::Pose{.lat_deg = target.lat,
                                       .lon_deg = target.lon,
                                       .altitude_m = std::nullopt,
                                       .heading_deg = std::nullopt};
  Report(moment, kRunning, out);
  left_s_ = random_.Between(1, 3);
}

void Missions::End(const Moment& moment, Facts& facts, Outbox& out) {
  const bool whole = *report_.current_step == *report_.total_steps;
  report_.current_target.reset();
  report_.current_path_id.reset();
  report_.time_completed_ms = moment.now_ms;
  if (whole) {
    report_.progress_x100 = kWholeX100;
    Report(moment, kComplete, out);
    if (!report_.mission_id.empty()) {
      out.emplace_back(
          model::EventTelemetry{moment.now_ms, model::MissionCompletedEvent{report_.mission_id}});
    }
    ++facts.missions_done;
    Tell(moment, model::MessageLevel::kInfo, "done", out);
  } else {
    const bool failed = random_.Chance(0.5);
    report_.status_message = failed ? "the deck is jammed" : "called off by the operator";
    Report(moment, failed ? kError : kAborted, out);
    Tell(moment, model::MessageLevel::kError, *report_.status_message, out);
  }
  facts.mission_active = false;
  facts.mission_name.clear();
  late_report_ = random_.Chance(0.2);
  left_s_ = random_.Between(1, kPauseBetweenS);
}

}  // namespace uplink::synthetic
