#include <optional>
#include <utility>
#include <variant>

#include "schema/json/exact.h"
#include "schema/json/fields.h"
#include "schema/json/render.h"

namespace uplink::json {
namespace {

using boost::json::object;

/// What one event kind holds; one overload an alternative.
struct DetailRenderer {
  object operator()(const model::EstopEngagedEvent&) const { return {}; }
  object operator()(const model::EstopReleasedEvent&) const { return {}; }
  object operator()(const model::ModeChangedEvent& event) const {
    return Fields().Set("from", event.from).Set("to", event.to).Take();
  }
  object operator()(const model::MissionStartedEvent& event) const {
    return Fields().Set("missionId", event.mission_id).Take();
  }
  object operator()(const model::MissionCompletedEvent& event) const {
    return Fields().Set("missionId", event.mission_id).Take();
  }
  object operator()(const model::FaultRaisedEvent& event) const {
    return Fields().Set("faultCode", event.fault_code).Set("description", event.description).Take();
  }
  object operator()(const model::FaultClearedEvent& event) const {
    return Fields().Set("faultCode", event.fault_code).Take();
  }
  object operator()(const model::NamedEvent& event) const {
    std::optional<boost::json::value> detail = ParseExact(event.detail_json);
    if (!detail || !detail->is_object()) return {};
    return std::move(detail->get_object());
  }
};

bool IsVoid(const model::EventKind& kind) {
  return std::holds_alternative<model::EstopEngagedEvent>(kind) ||
         std::holds_alternative<model::EstopReleasedEvent>(kind);
}

}  // namespace

object RenderDetail(const model::EventKind& kind) { return std::visit(DetailRenderer(), kind); }

object Render(const model::EventTelemetry& body) {
  Fields kind;
  const std::string_view name = model::EventKindText(body.kind);
  if (IsVoid(body.kind)) {
    kind.Set(name, boost::json::value(nullptr));
  } else {
    kind.Set(name, RenderDetail(body.kind));
  }
  return Fields().Set("unixTimeMs", body.unix_time_ms).Set("kind", kind.Take()).Take();
}

object Render(const model::Fault& body) {
  return Fields()
      .Set("unixTimeMs", body.unix_time_ms)
      .Set("faultId", body.fault_id)
      .Set("source", body.source)
      .Set("severity", body.severity)
      .Set("active", body.active)
      .Set("category", body.category)
      .Set("description", body.description)
      .Set("suggestedAction", body.suggested_action)
      .Take();
}

object Render(const model::Message& body) {
  return Fields()
      .Set("unixTimeMs", body.unix_time_ms)
      .Set("level", body.level)
      .Set("message", body.message)
      .Take();
}

}  // namespace uplink::json
