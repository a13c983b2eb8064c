#include "schema/json/fields.h"
#include "schema/json/render.h"

namespace uplink::json {
namespace {

using boost::json::object;

object RenderReading(const model::SensorReading& reading) {
  return Fields()
      .Set("key", reading.key)
      .Set("value", Render(reading.value))
      .SetIf("unixTimeMs", reading.unix_time_ms)
      .Take();
}

}  // namespace

object Render(const model::TelemetryExtras& body) {
  return Fields()
      .Set("unixTimeMs", body.unix_time_ms)
      .Set("kv", ListOf(body.kv, RenderReading))
      .Take();
}

}  // namespace uplink::json
