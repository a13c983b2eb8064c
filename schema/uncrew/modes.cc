#include "schema/uncrew/families.h"

namespace uplink::uncrew {

namespace uc = model::uncrew;

uc::Armed Read(Reader& /*in*/, const v1::TelemetryArmed& from) {
  return {.is_armed = from.has_is_armed() ? std::optional(from.is_armed()) : std::nullopt};
}

uc::FlightMode Read(Reader& in, const v1::TelemetryFlightMode& from) {
  return {.mode = in.Enum<uc::FlightModeKind>(from.mode())};
}

uc::UncrewFlightMode Read(Reader& in, const v1::TelemetryUncrewFlightMode& from) {
  return {.mode = in.Text("mode", from.mode(), schema::kNameBytesMax),
          .detail = in.Text("detail", from.detail(), schema::kDescriptionBytesMax)};
}

uc::CurrentMissionItem Read(Reader& in, const v1::TelemetryCurrentMissionItem& from) {
  uc::CurrentMissionItem item{
      .total = in.NotNegative("total", from.has_total(), from.total()),
      .mission_id = in.Text("mission_id", from.mission_id(), schema::kIdBytesMax)};
  item.current = item.total ? in.InRange("current", from.has_current(), from.current(),
                                         {0, static_cast<double>(*item.total)})
                            : in.NotNegative("current", from.has_current(), from.current());
  return item;
}

}  // namespace uplink::uncrew
