#include "tools/uplink-fleet/drone/sets.h"

#include <utility>

#include <boost/json.hpp>

#include "schema/base/rfc3339.h"
#include "tools/uplink-fleet/twin/canonical.h"

namespace uplink::synthetic {
namespace {

namespace js = boost::json;
using ::uncrew::v1::Alert;
using ::uncrew::v1::OperatorActionRequest;

constexpr const char* kSource = "uncrew";
/// Of changes, those by which one comes.
constexpr double kComesShare = 0.55;

enum class AlertKind : std::uint8_t { kBattery, kPercentage, kTermination };

js::object ShownOf(const Alert& alert, const std::string& category, std::int64_t sampled_us) {
  js::object shown{{"alertId", alert.alert_id()},
                   {"kind", category},
                   {"raisedAtUs", alert.raised_at_unix_us()},
                   {"sampledAt", Rfc3339OfUs(sampled_us)},
                   {"reaction", alert.reaction().has_rtl() ? "return_to_launch" : "none"}};
  if (!alert.text().empty()) shown["text"] = alert.text();
  if (alert.has_battery()) {
    shown["batteryId"] = alert.battery().battery_id();
    shown["condition"] = alert.battery().condition();
  } else if (alert.has_battery_percentage()) {
    shown["batteryId"] = alert.battery_percentage().battery_id();
    shown["remainingPercent"] = static_cast<double>(alert.battery_percentage().remaining_percent());
    shown["thresholdPercent"] = static_cast<double>(alert.battery_percentage().threshold_percent());
  } else {
    shown["cause"] = alert.flight_termination().cause();
  }
  return shown;
}

const char* KindOf(const OperatorActionRequest& request) {
  return request.has_confirm_delivery_ready() ? "confirm_delivery_ready"
                                              : "confirm_delivery_complete";
}

/// The outcomes that are due of a set; what an earlier run left is not known.
Outcomes DueOf(bool said_before, bool changed) {
  if (!said_before) return kIsGood;
  return changed ? kStores : kIsKnown;
}

}  // namespace

AvatarCall DroneSets::Alerts(double share) {
  AvatarDraft draft = speech_.voice.Begin("Alert", alerts_line_, R"({"alerts":{}})", chance_);
  const bool changes = chance_.Chance(share) && !speech_.account.Full();
  if (changes) {
    const bool comes = chance_.Chance(kComesShare) && alerts_.size() < kActiveMax;
    if (comes || alerts_.empty()) {
      Raise(draft);
    } else {
      Clear(draft);
    }
  }
  auto& request = static_cast<::uncrew::v1::PublishAlertRequest&>(*draft.request);
  for (const auto& [alert, category, description] : alerts_) {
    *request.mutable_alerts()->add_alerts() = alert;
    speech_.account.Live("alerts/" + alert.alert_id(), ShownOf(alert, category, draft.time_us));
  }
  draft.call.due.outcomes = DueOf(std::exchange(alerts_said_, true), changes);
  return DroneVoice::Finish(std::move(draft));
}

void DroneSets::Raise(const AvatarDraft& draft) {
  const std::string id = speech_.voice.IdOf("alert", draft);
  Alert alert;
  alert.set_alert_id(id);
  alert.set_raised_at_unix_us(draft.time_us);
  alert.mutable_reaction()->mutable_none();
  switch (AlertKind(chance_.Below(3))) {
    case AlertKind::kBattery:
      alert.mutable_battery()->set_battery_id(1);
      alert.mutable_battery()->set_condition("cells differ");
      alerts_.push_back({alert, "battery", "cells differ"});
      break;
    case AlertKind::kPercentage:
      alert.set_text("low: " + id);
      alert.mutable_reaction()->mutable_rtl();
      alert.mutable_battery_percentage()->set_remaining_percent(17.5F);
      alert.mutable_battery_percentage()->set_threshold_percent(20);
      alerts_.push_back({alert, "battery_percentage", alert.text()});
      break;
    case AlertKind::kTermination:
      alert.mutable_flight_termination()->set_cause("geofence");
      alerts_.push_back({alert, "flight_termination", "geofence"});
      break;
  }
  NoteFault(draft, alerts_.back(), true);
}

void DroneSets::Clear(const AvatarDraft& draft) {
  const auto gone = alerts_.begin() + static_cast<std::ptrdiff_t>(chance_.Below(alerts_.size()));
  NoteFault(draft, *gone, false);
  speech_.account.NoLongerLive("alerts/" + gone->alert.alert_id());
  alerts_.erase(gone);
}

void DroneSets::NoteFault(const AvatarDraft& draft, const Active& alert, bool active) {
  const std::string& id = alert.alert.alert_id();
  const bool ends = alert.alert.has_flight_termination();
  speech_.account.Row(draft.call.number,
                      {.list = DroneList::kFaults,
                       .key = FaultKey(id, active),
                       .content = FaultContent({.id = id,
                                                .active = active,
                                                .source = kSource,
                                                .severity = ends ? "critical" : "major",
                                                .category = alert.category,
                                                .description = alert.description,
                                                .sampled_ms = draft.time_ms()})});
  speech_.account.Raised(id, active);
}

AvatarCall DroneSets::Requests(double share) {
  AvatarDraft draft = speech_.voice.Begin("OperatorActionRequests", requests_line(),
                                          R"({"operator_action_requests":{}})", chance_);
  const bool changes = chance_.Chance(share) && !speech_.account.Full();
  if (changes &&
      (requests_.empty() || (requests_.size() < kActiveMax && chance_.Chance(kComesShare)))) {
    Open(draft);
  } else if (changes) {
    const std::string id = requests_.front().request_id();
    requests_.erase(requests_.begin());
    speech_.account.Closed(draft.call.number, id);
    speech_.account.NoLongerLive("operatorRequests/" + id);
  }
  auto& said = static_cast<::uncrew::v1::PublishOperatorActionRequestsRequest&>(*draft.request);
  for (const OperatorActionRequest& request : requests_) {
    *said.mutable_operator_action_requests()->add_requests() = request;
    speech_.account.Live("operatorRequests/" + request.request_id(),
                         {{"requestId", request.request_id()},
                          {"kind", KindOf(request)},
                          {"requestedAtUs", request.requested_at_unix_us()},
                          {"text", request.text()},
                          {"sampledAt", Rfc3339OfUs(draft.time_us)}});
  }
  draft.call.due.outcomes = DueOf(std::exchange(requests_said_, true), changes);
  return DroneVoice::Finish(std::move(draft));
}

void DroneSets::Open(const AvatarDraft& draft) {
  OperatorActionRequest request;
  request.set_request_id(speech_.voice.IdOf("request", draft));
  request.set_requested_at_unix_us(draft.time_us);
  request.set_text("asks " + request.request_id());
  if (chance_.Chance(0.5)) {
    request.mutable_confirm_delivery_ready();
  } else {
    request.mutable_confirm_delivery_complete();
  }
  speech_.account.Opened(draft.call.number, request.request_id(),
                         RequestContent(KindOf(request), request.text(), draft.time_ms()));
  requests_.push_back(std::move(request));
}

}  // namespace uplink::synthetic
