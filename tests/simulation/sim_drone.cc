#include "tests/simulation/sim_drone.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "server/uncrew/sample_digest.h"

namespace uplink::simulation {

namespace pb = ::uncrew::v1;

namespace {

/// Civil time of the drones' first sample, by a clock of their own.
constexpr std::int64_t kUnixMs = 1'763'683'200'000;
constexpr std::int64_t kUsPerMs = 1'000;
/// Batteries that are told apart; the server keeps eight.
constexpr std::size_t kBatteries = 10;
constexpr std::size_t kItemsMax = 6;
constexpr std::size_t kItemIds = 8;
/// Past the bound of a code.
constexpr std::size_t kLongCode = 300;

constexpr auto kTextTypes =
    std::to_array<SampleType>({SampleType::kStatusText, SampleType::kError,
                               SampleType::kConnectionEvent, SampleType::kCommandResult});
constexpr auto kModeTypes = std::to_array<SampleType>(
    {SampleType::kArmed, SampleType::kFlightMode, SampleType::kUncrewFlightMode});
constexpr auto kSetTypes =
    std::to_array<SampleType>({SampleType::kAlerts, SampleType::kOperatorRequests});

/// The names of the modes in which drones fly, by their numbers from 1.
constexpr auto kFlightModes = std::to_array<std::string_view>({"ready", "takeoff", "hold"});

std::string RuriOf(std::size_t index) {
  return fmt::format("rcan://local.rcan/uncrew/uav/{}", index);
}

identity::PeerIdentity PeerOf(std::size_t index, bool by_gateway) {
  identity::PeerIdentity peer{.fleet = "drones"};
  if (by_gateway) {
    peer.role = identity::Role::kGateway;
    peer.gateway.subject = "CN=gateway";
  } else {
    peer.ruri = RuriOf(index);
  }
  return peer;
}

template <typename Types>
bool Contains(const Types& types, SampleType type) {
  return std::ranges::find(types, type) != types.end();
}

}  // namespace

std::int64_t DroneSample::unix_ms() const { return kUnixMs + static_cast<std::int64_t>(number); }

std::string ToText(const DroneSample& sample) {
  return fmt::format("{} {}", model::uncrew::RowOf(sample.type).name, sample.number);
}

SimDrone::SimDrone(std::size_t index, bool by_gateway, OnItsWay on_its_way)
    : uav_id_(std::to_string(index)),
      ruri_(RuriOf(index)),
      peer_(PeerOf(index, by_gateway)),
      by_gateway_(by_gateway),
      on_its_way_(std::move(on_its_way)) {}

DroneSample SimDrone::Begin(SampleType type, SteadyTime now) const {
  const auto up = std::chrono::duration_cast<std::chrono::microseconds>(now.time_since_epoch());
  const std::uint64_t number = made_.size() + 1;
  return {.number = number,
          .type = type,
          .boot_us = boot_base_us_ + static_cast<std::uint64_t>(up.count()) + number};
}

template <typename Request>
DroneSampleRef SimDrone::Make(DroneSample sample, Request request) {
  pb::Metadata& metadata = *request.mutable_metadata();
  if (by_gateway_) metadata.set_uav_id(uav_id_);
  metadata.set_sampled_at_unix_us(sample.unix_ms() * kUsPerMs);
  metadata.set_sampled_at_boot_us(sample.boot_us);
  sample.bytes = request.SerializeAsString();
  sample.digest = uncrew::DigestOf(sample.type, sample.bytes);
  sample.alone = !on_its_way_(sample.type);
  made_.push_back(std::make_shared<const DroneSample>(std::move(sample)));
  return made_.back();
}

DroneSampleRef SimDrone::Await(DroneSampleRef sample) {
  pending_[sample->type] = sample;
  return sample;
}

DroneSampleRef SimDrone::MakeHeading(SteadyTime now) {
  pb::PublishHeadingRequest request;
  request.mutable_heading()->set_heading_deg(static_cast<double>(made_.size() % 360));
  return Make(Begin(SampleType::kHeading, now), std::move(request));
}

DroneSampleRef SimDrone::MakeLive(SteadyTime now, Random& random) {
  const std::size_t pick = random.Below(100);
  if (pick < 20 && last_live_ != nullptr) return last_live_;
  if (pick < 45) return last_live_ = MakeHeading(now);
  if (pick < 55) {
    DroneSample sample = Begin(SampleType::kHeading, now);
    sample.bad = true;
    pb::PublishHeadingRequest request;
    request.mutable_heading()->set_heading_deg(std::numeric_limits<double>::infinity());
    return last_live_ = Make(std::move(sample), std::move(request));
  }
  DroneSample sample = Begin(SampleType::kBattery, now);
  pb::PublishBatteryRequest request;
  const auto id = static_cast<std::uint32_t>(random.Below(kBatteries));
  sample.key = id;
  request.mutable_battery()->set_id(id);
  request.mutable_battery()->set_remaining_percent(static_cast<float>(random.Below(100)));
  return last_live_ = Make(std::move(sample), std::move(request));
}

DroneSampleRef SimDrone::Happen(SteadyTime now, Random& random) {
  const std::size_t pick = random.Below(100);
  if (pick < 35) return MakeText(kTextTypes[random.Below(kTextTypes.size())], now, random);
  if (pick < 65) {
    const SampleType type = kModeTypes[random.Below(kModeTypes.size())];
    // While the last one waits, the next one waits for it.
    if (pending_.contains(type)) return nullptr;
    std::size_t& mode = modes_[type];
    mode = random.Below(kFlightModes.size());
    return MakeMode(type, now);
  }
  const SampleType type = kSetTypes[random.Below(kSetTypes.size())];
  // One that waits and has no answer may give way to a newer one.
  if (pending_.contains(type) && on_its_way_(type)) return nullptr;
  std::set<std::string>& set = type == SampleType::kAlerts ? alerts_ : requests_;
  for (std::size_t changes = 1 + random.Below(3); changes > 0; --changes) {
    const std::string id =
        fmt::format("{}{}", type == SampleType::kAlerts ? 'a' : 'r', random.Below(kItemIds));
    if (set.erase(id) == 0 && set.size() < kItemsMax) set.insert(id);
  }
  return MakeSet(type, now);
}

DroneSampleRef SimDrone::Repeat(SampleType type, SteadyTime now) {
  if (pending_.contains(type)) return nullptr;
  return IsSetType(type) ? MakeSet(type, now) : MakeMode(type, now);
}

DroneSampleRef SimDrone::MakeText(SampleType type, SteadyTime now, Random& random) {
  if (pending_.contains(type)) return nullptr;
  DroneSample sample = Begin(type, now);
  const std::string text = fmt::format("n{}", sample.number);
  switch (type) {
    case SampleType::kStatusText: {
      pb::PublishStatusTextRequest request;
      request.mutable_status_text()->set_text(text);
      return Await(Make(std::move(sample), std::move(request)));
    }
    case SampleType::kConnectionEvent: {
      pb::PublishConnectionEventRequest request;
      request.mutable_connection_event()->set_text(text);
      return Await(Make(std::move(sample), std::move(request)));
    }
    case SampleType::kCommandResult: {
      pb::PublishUAVCommandResultRequest request;
      request.set_command_id(text);
      request.mutable_status()->set_state(pb::ProcedureStatus::STATE_SUCCEEDED);
      return Await(Make(std::move(sample), std::move(request)));
    }
    default: {
      pb::PublishErrorRequest request;
      request.mutable_error()->set_text(text);
      sample.bad = random.Percent(30);
      if (sample.bad) request.mutable_error()->set_code(std::string(kLongCode, 'c'));
      return Await(Make(std::move(sample), std::move(request)));
    }
  }
}

std::string SimDrone::ModeOf(SampleType type) const {
  const auto found = modes_.find(type);
  const std::size_t mode = found == modes_.end() ? 0 : found->second;
  if (type == SampleType::kArmed) return mode == 0 ? "false" : "true";
  return fmt::format("\"{}\"", kFlightModes[mode]);
}

DroneSampleRef SimDrone::MakeMode(SampleType type, SteadyTime now) {
  DroneSample sample = Begin(type, now);
  sample.mode = ModeOf(type);
  const std::size_t mode = modes_[type];
  if (type == SampleType::kArmed) {
    pb::PublishArmedRequest request;
    request.mutable_armed()->set_is_armed(mode != 0);
    return Await(Make(std::move(sample), std::move(request)));
  }
  if (type == SampleType::kFlightMode) {
    pb::PublishFlightModeRequest request;
    request.mutable_flight_mode()->set_mode(static_cast<pb::FlightMode>(mode + 1));
    return Await(Make(std::move(sample), std::move(request)));
  }
  pb::PublishUncrewFlightModeRequest request;
  request.mutable_uncrew_flight_mode()->set_mode(std::string(kFlightModes[mode]));
  return Await(Make(std::move(sample), std::move(request)));
}

DroneSampleRef SimDrone::MakeSet(SampleType type, SteadyTime now) {
  DroneSample sample = Begin(type, now);
  if (type == SampleType::kAlerts) {
    sample.items = alerts_;
    pb::PublishAlertRequest request;
    pb::Alerts& alerts = *request.mutable_alerts();
    for (const std::string& id : alerts_) {
      pb::Alert& alert = *alerts.add_alerts();
      alert.set_alert_id(id);
      alert.mutable_flight_termination();
    }
    return Await(Make(std::move(sample), std::move(request)));
  }
  sample.items = requests_;
  pb::PublishOperatorActionRequestsRequest request;
  pb::OperatorActionRequests& waiting = *request.mutable_operator_action_requests();
  for (const std::string& id : requests_) {
    pb::OperatorActionRequest& each = *waiting.add_requests();
    each.set_request_id(id);
    each.mutable_confirm_delivery_ready();
  }
  return Await(Make(std::move(sample), std::move(request)));
}

bool SimDrone::Awaits(const DroneSample& sample) const {
  const auto waits = pending_.find(sample.type);
  return waits != pending_.end() && waits->second->number == sample.number;
}

void SimDrone::OnAnswered(const DroneSample& sample) {
  if (Awaits(sample)) pending_.erase(sample.type);
}

std::vector<DroneSampleRef> SimDrone::Pending() const {
  std::vector<DroneSampleRef> samples;
  samples.reserve(pending_.size());
  for (const auto& [type, sample] : pending_) samples.push_back(sample);
  return samples;
}

}  // namespace uplink::simulation
