#include "tools/uplink-fleet/robot/script.h"

#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "schema/encode.h"
#include "schema/json/render.h"

namespace uplink::synthetic {
namespace {

constexpr double kFuelPct = 63.5;
/// Metres and seconds that a full battery is good for.
constexpr double kRangeM = 1800;
constexpr double kRuntimeS = 1200;
/// Between two states of an arm.
constexpr double kArmStateS = 1;

/// One source of chance for each behaviour of each robot.
Seeded SourceFor(const ScenarioOptions& options, std::size_t index, std::uint64_t behaviour) {
  Seeded seed(options.seed * 0x9E37'79B9'7F4A'7C15ULL + index);
  return Seeded(seed.Next() + behaviour);
}

/// As Outgoing::latest_of.
std::string LatestOf(const model::Body& body) {
  std::string kind(ToText(model::VariantOf(body)));
  if (const auto* shape = std::get_if<model::ShapeOp>(&body)) return kind + "/" + shape->id();
  if (const auto* object = std::get_if<model::ObjectOp>(&body)) return kind + "/" + object->id();
  const bool one = std::holds_alternative<model::UiCapabilities>(body) ||
                   std::holds_alternative<model::CurrentSettings>(body) ||
                   std::holds_alternative<model::AgentInfo>(body);
  return one ? kind : std::string();
}

Outgoing Enter(const model::Body& body, Account& account) {
  Outgoing message{.payload = schema::Encode(body)};
  if (model::IsDurable(model::VariantOf(body))) {
    message.keeping = Keeping::kDurable;
    message.latest_of = LatestOf(body);
    message.tag = account.Enter(body);
  } else {
    account.EnterLive(body);
  }
  return message;
}

std::vector<Outgoing> EnterAll(const Outbox& out, Account& account) {
  std::vector<Outgoing> messages;
  messages.reserve(out.size());
  for (const model::Body& body : out) messages.push_back(Enter(body, account));
  return messages;
}

}  // namespace

std::string MarkOf(const std::string& run, std::size_t index) {
  return fmt::format("{}-{}", run, index + 1);
}

std::string SourceOf(const std::string& run) { return fmt::format("uplink-fleet/{}", run); }

RobotScript::RobotScript(const ScenarioOptions& options, std::size_t index)
    : RobotScript(options, index, MarkOf(options.run, index)) {}

RobotScript::RobotScript(const ScenarioOptions& options, std::size_t index, const std::string& mark)
    : options_(options),
      index_(index),
      tick_s_(1 / options.rate_hz),
      random_(SourceFor(options, index, 0)),
      route_(SourceFor(options, index, 1)),
      battery_(SourceFor(options, index, 2)),
      controls_(SourceFor(options, index, 3)),
      missions_(SourceFor(options, index, 4), mark),
      faults_(SourceFor(options, index, 5), mark, SourceOf(options.run), options.faults_hz),
      coverage_(SourceFor(options, index, 6), mark),
      objects_(SourceFor(options, index, 7), mark),
      sharing_(SourceFor(options, index, 12), mark, options.run),
      settings_(SourceFor(options, index, 8)),
      equipment_(SourceFor(options, index, 9)),
      wrong_(SourceFor(options, index, 10), mark),
      status_(1 / options.status_hz, random_.Unit() / options.status_hz),
      arm_(SourceFor(options, index, 11)),
      arm_state_(kArmStateS, random_.Unit() * kArmStateS) {}

void RobotScript::Adopt(const ScenarioOptions& options) {
  options_.rate_hz = options.rate_hz;
  options_.malformed_share = options.malformed_share;
  options_.pace = options.pace;
  options_.rcan_share = options.rcan_share;
  tick_s_ = 1 / options.rate_hz;
  faults_.SetRate(options.faults_hz);
  status_.SetPeriod(1 / options.status_hz);
}

std::vector<Outgoing> RobotScript::Tick(std::int64_t now_ms, Account& account) {
  const Moment clock{now_ms, tick_s_};
  const Moment lived{now_ms, tick_s_ * options_.pace};
  Outbox out;
  route_.Advance(clock, facts_);
  out.emplace_back(route_.Motion(clock, facts_));
  battery_.Advance(lived, facts_, out);
  controls_.Advance(lived, facts_, out);
  missions_.Advance(lived, facts_, route_, out);
  // Reports per second are the flag's own.
  faults_.Advance(clock, facts_, out);
  coverage_.Advance(lived, facts_, missions_, route_, out);
  objects_.Advance(lived, facts_, out);
  sharing_.Advance(lived, facts_, out);
  settings_.Advance(lived, out);
  equipment_.Advance(lived, facts_, route_, out);
  if (status_.Passed(tick_s_)) out.emplace_back(Status(clock));
  std::vector<Outgoing> messages = EnterAll(out, account);
  arm_.Advance(clock, facts_);
  if (HasArm() && arm_state_.Passed(tick_s_)) messages.push_back(ArmState(clock, account));
  if (random_.Chance(options_.malformed_share)) messages.push_back(wrong_.Next(now_ms, account));
  return messages;
}

Outgoing RobotScript::OnlyMove(std::int64_t now_ms, Account& account) {
  const Moment clock{now_ms, tick_s_};
  route_.Advance(clock, facts_);
  return Enter(route_.Motion(clock, facts_), account);
}

Outgoing RobotScript::Motion(std::int64_t now_ms, Account& account) {
  facts_.speed_mps = 0;
  facts_.turn_rps = 0;
  return Enter(route_.Motion({now_ms, tick_s_}, facts_), account);
}

Outgoing RobotScript::Again(std::int64_t now_ms, Account& account) {
  return Enter(route_.Motion({now_ms, 0}, facts_), account);
}

std::vector<Outgoing> RobotScript::Answer(const v1::ResendRequest& request, Account& account) {
  Outbox out;
  for (const int kind : request.kinds()) {
    if (kind == v1::RESEND_KIND_UI_CAPABILITIES) out.emplace_back(settings_.capabilities());
    if (kind == v1::RESEND_KIND_CURRENT_SETTINGS) out.emplace_back(settings_.current());
    if (kind == v1::RESEND_KIND_AGENT_INFO) equipment_.Info(out);
  }
  return EnterAll(out, account);
}

std::vector<Outgoing> RobotScript::Last(std::int64_t now_ms, Account& account) {
  const Moment moment{now_ms, tick_s_};
  Outbox out;
  out.emplace_back(route_.Motion(moment, facts_));
  out.emplace_back(Status(moment));
  equipment_.All(moment, facts_, route_, out);
  std::vector<Outgoing> messages = EnterAll(out, account);
  if (HasArm()) messages.push_back(ArmState(moment, account));
  return messages;
}

bool RobotScript::HasArm() const {
  if (ruri_.empty()) return false;
  // Spread evenly over the fleet.
  const double before = options_.rcan_share * static_cast<double>(index_);
  return std::floor(before + options_.rcan_share) > std::floor(before);
}

Outgoing RobotScript::ArmState(const Moment& moment, Account& account) {
  model::RcanState state = arm_.State(moment, facts_);
  std::string text = boost::json::serialize(json::Render(state, ruri_));
  account.EnterRcan(std::move(state));
  return {Keeping::kLive, Content::kRcanRobotState, std::move(text), 0, {}};
}

model::StatusTelemetry RobotScript::Status(const Moment& moment) const {
  model::StatusTelemetry status;
  status.unix_time_ms = moment.now_ms;
  status.battery = battery_.Status(facts_);
  status.mode = facts_.mode;
  status.estop = controls_.EStop();
  status.faulted = facts_.faulted;
  status.mission_active = facts_.mission_active;
  status.status = facts_.estop            ? "emergency stop"
                  : facts_.charging       ? "charging"
                  : facts_.mission_active ? facts_.mission_name
                                          : fmt::format("robot {} is ready", index_ + 1);
  // Every fifth robot has an engine beside its battery.
  if (index_ % 5 == 4) {
    status.fuel = model::FuelStatus();
    status.fuel->level_pct = static_cast<float>(kFuelPct);
    status.fuel->volume_unit = "l";
  }
  status.range_remaining = kRangeM * facts_.soc_pct / 100;
  status.runtime_remaining = kRuntimeS * facts_.soc_pct / 100;
  return status;
}

}  // namespace uplink::synthetic
