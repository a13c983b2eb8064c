#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "schema/uncrew/families.h"
#include "schema/uncrew/limits.h"

namespace uplink::uncrew {
namespace {

namespace uc = model::uncrew;
using schema::kDescriptionBytesMax;
using schema::kIdBytesMax;
using schema::kNameBytesMax;

/// Alerts that their drone does not name are known by what they are about.
std::string OwnId(const uc::Alert& alert) {
  std::string id = model::EnumText(alert.kind);
  if (alert.battery_id) id.append("/").append(std::to_string(*alert.battery_id));
  return id;
}

void ReadKind(Reader& in, const v1::Alert& from, uc::Alert& alert) {
  switch (from.kind_case()) {
    case v1::Alert::kBattery: {
      const v1::AlertBattery& battery = from.battery();
      alert.kind = uc::AlertKind::kBattery;
      alert.battery_id = battery.battery_id();
      const schema::Path path = in.path().Field("battery");
      Reader within(in.violations(), path);
      alert.condition = within.Text("condition", battery.condition(), kNameBytesMax);
      return;
    }
    case v1::Alert::kBatteryPercentage: {
      const v1::AlertBatteryPercentage& battery = from.battery_percentage();
      alert.kind = uc::AlertKind::kBatteryPercentage;
      alert.battery_id = battery.battery_id();
      const schema::Path path = in.path().Field("battery_percentage");
      Reader within(in.violations(), path);
      alert.remaining_percent = within.Percent("remaining_percent", battery.has_remaining_percent(),
                                               battery.remaining_percent());
      alert.threshold_percent = within.Percent("threshold_percent", battery.has_threshold_percent(),
                                               battery.threshold_percent());
      return;
    }
    case v1::Alert::kFlightTermination: {
      alert.kind = uc::AlertKind::kFlightTermination;
      const schema::Path path = in.path().Field("flight_termination");
      Reader within(in.violations(), path);
      alert.cause = within.Text("cause", from.flight_termination().cause(), kDescriptionBytesMax);
      return;
    }
    case v1::Alert::KIND_NOT_SET:
      in.violations().Content(schema::WithoutKind(in.path()));
      return;
  }
}

uc::Alert ReadAlert(Reader& in, const v1::Alert& from) {
  uc::Alert alert;
  ReadKind(in, from, alert);
  alert.alert_id =
      from.alert_id().empty() ? OwnId(alert) : in.Text("alert_id", from.alert_id(), kIdBytesMax);
  alert.raised_at_us = in.TimeUs(from.raised_at_unix_us());
  alert.text = in.Text("text", from.text(), kDescriptionBytesMax);
  switch (from.reaction().reaction_case()) {
    case v1::AlertReaction::kNone:
      alert.reaction = uc::AlertReaction::kNone;
      break;
    case v1::AlertReaction::kRtl:
      alert.reaction = uc::AlertReaction::kReturnToLaunch;
      break;
    case v1::AlertReaction::REACTION_NOT_SET:
      break;
  }
  return alert;
}

uc::OperatorActionRequest ReadRequest(Reader& in, const v1::OperatorActionRequest& from) {
  uc::OperatorActionRequest request;
  request.request_id = in.RequiredText("request_id", from.request_id(), kIdBytesMax);
  request.requested_at_us = in.TimeUs(from.requested_at_unix_us());
  request.text = in.Text("text", from.text(), kDescriptionBytesMax);
  switch (from.kind_case()) {
    case v1::OperatorActionRequest::kConfirmDeliveryReady:
      request.kind = model::OperatorRequestKind::kConfirmDeliveryReady;
      break;
    case v1::OperatorActionRequest::kConfirmDeliveryComplete:
      request.kind = model::OperatorRequestKind::kConfirmDeliveryComplete;
      break;
    case v1::OperatorActionRequest::KIND_NOT_SET:
      in.violations().Content(schema::WithoutKind(in.path()));
      break;
  }
  return request;
}

/// How a list of a set is read.
struct SetRules {
  std::size_t items_max;
  std::string_view what;
  std::string_view id;
};

/// The items of a set, each by `read`; no two have the same `id_of`.
template <typename List, typename ReadItem, typename IdOf>
auto ReadSet(Reader& in, const List& from, const SetRules& rules, ReadItem read, IdOf id_of) {
  std::vector<std::invoke_result_t<ReadItem, Reader&, typename List::const_reference>> items;
  const auto count = static_cast<std::size_t>(from.size());
  if (count > rules.items_max) {
    in.violations().Reject(schema::TooManyItems(in.path(), count, rules.items_max, rules.what));
    return items;
  }
  items.reserve(count);
  for (const auto& each : from) {
    const schema::Path path = in.path().Item(items.size());
    Reader item(in.violations(), path);
    auto read_item = read(item, each);
    for (const auto& other : items) {
      if (id_of(other) != id_of(read_item)) continue;
      in.violations().Content(schema::DuplicateKey(path.Field(rules.id), id_of(read_item)));
    }
    items.push_back(std::move(read_item));
  }
  return items;
}

}  // namespace

uc::StatusText Read(Reader& in, const v1::TelemetryStatusText& from) {
  return {.type = in.Enum<uc::StatusTextLevel>(from.type()),
          .text = in.RequiredText("text", from.text(), kDescriptionBytesMax)};
}

uc::Error Read(Reader& in, const v1::TelemetryError& from) {
  return {.code = in.Text("code", from.code(), kNameBytesMax),
          .text = in.RequiredText("text", from.text(), kDescriptionBytesMax),
          .source = in.Text("source", from.source(), kNameBytesMax),
          .command_id = in.Text("command_id", from.command_id(), kIdBytesMax)};
}

uc::ConnectionEvent Read(Reader& in, const v1::TelemetryConnectionEvent& from) {
  return {.kind = in.Enum<uc::ConnectionEventKind>(from.kind()),
          .link = in.Text("link", from.link(), kNameBytesMax),
          .text = in.RequiredText("text", from.text(), kDescriptionBytesMax)};
}

uc::CommandResult Read(Reader& in, const v1::ProcedureStatus& from) {
  return {.command_id = {},
          .state = in.Enum<uc::ProcedureState>(from.state()),
          .code = in.Text("code", from.code(), kNameBytesMax),
          .text = in.Text("text", from.text(), kDescriptionBytesMax)};
}

uc::Alerts Read(Reader& in, const v1::Alerts& from) {
  return {ReadSet(in, from.alerts(), {.items_max = kAlertsMax, .what = "alerts", .id = "alert_id"},
                  ReadAlert,
                  [](const uc::Alert& alert) -> std::string_view { return alert.alert_id; })};
}

uc::OperatorRequests Read(Reader& in, const v1::OperatorActionRequests& from) {
  return {ReadSet(in, from.requests(),
                  {.items_max = kOperatorRequestsMax, .what = "requests", .id = "request_id"},
                  ReadRequest, [](const uc::OperatorActionRequest& request) -> std::string_view {
                    return request.request_id;
                  })};
}

}  // namespace uplink::uncrew
