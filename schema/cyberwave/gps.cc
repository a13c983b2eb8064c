#include <optional>

#include "schema/cyberwave/families.h"
#include "schema/limits.h"
#include "schema/rules/motion.h"

namespace uplink::cyberwave {

using model::cyberwave::Gps;

namespace {

/// Both, or neither.
void ReadPlace(Reader& in, Gps& gps) {
  const bool latitude = in.Find("latitude") != nullptr;
  const bool longitude = in.Find("longitude") != nullptr;
  const std::optional<double> latitude_deg =
      in.NumberIn("latitude", {.min = -schema::kLatitudeDegMax, .max = schema::kLatitudeDegMax});
  const std::optional<double> longitude_deg =
      in.NumberIn("longitude", {.min = -schema::kLongitudeDegMax, .max = schema::kLongitudeDegMax});
  if (longitude && !latitude) in.Missing("latitude", Need::kMay);
  if (latitude && !longitude) in.Missing("longitude", Need::kMay);
  if (!latitude_deg || !longitude_deg) return;
  gps.latitude_deg = latitude_deg;
  gps.longitude_deg = longitude_deg;
}

}  // namespace

Gps ReadGps(Reader& in) {
  Gps gps;
  ReadPlace(in, gps);
  gps.altitude_m =
      in.NumberIn("altitude", {.min = schema::kAltitudeMMin, .max = schema::kAltitudeMMax});
  gps.compass_heading_deg = in.Number("compass_heading");
  if (gps.compass_heading_deg) {
    gps.compass_heading_deg = schema::NormalizedHeading(*gps.compass_heading_deg);
  }
  gps.horizontal_accuracy_m = in.NotNegative("horizontal_accuracy");
  gps.vertical_accuracy_m = in.NotNegative("vertical_accuracy");
  gps.satellite_count = in.Count("satellite_count");
  gps.signal_level = in.Number("signal_level");
  gps.fix_type = in.Text("fix_type", schema::kNameBytesMax);
  if (gps == Gps()) in.violations().RejectIfAnyDropped();
  return gps;
}

}  // namespace uplink::cyberwave
