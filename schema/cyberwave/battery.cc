#include "schema/cyberwave/families.h"

namespace uplink::cyberwave {

using model::cyberwave::BatteryStatus;

BatteryStatus ReadBatteryStatus(Reader& in) {
  BatteryStatus battery;
  battery.percentage = in.Percent("percentage");
  battery.voltage_v = in.Number("voltage");
  battery.charging = in.Flag("charging");
  if (battery == BatteryStatus()) in.violations().RejectIfAnyDropped();
  return battery;
}

}  // namespace uplink::cyberwave
