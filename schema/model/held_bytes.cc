#include "schema/model/held_bytes.h"

#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "schema/model/uncrew/fields.h"

namespace uplink::model {
namespace {

/// What the allocator adds to each allocation: its header, and half of what it rounds up to.
constexpr std::size_t kAllocationBytes = 16;

std::size_t Allocated(std::size_t bytes) { return bytes == 0 ? 0 : bytes + kAllocationBytes; }

/// One overload for each way in which a value holds others; then one for each struct with a text or
/// a list, in the order of the headers. Structs without either hold nothing. A class, so that each
/// sees all.
struct Counter {
  template <typename T>
  static std::size_t Held(const T& /*plain*/) {
    static_assert(std::is_trivially_copyable_v<T>, "what holds memory needs an overload");
    return 0;
  }

  static std::size_t Held(const std::string& text) {
    // A short one lies within the string.
    return text.capacity() < sizeof(std::string) / 2 ? 0 : Allocated(text.capacity() + 1);
  }

  template <typename... T>
  static std::size_t HeldByAll(const T&... members) {
    return (Held(members) + ...);
  }

  static std::size_t Held(const EnumName& value) { return Held(value.name); }

  static std::size_t Held(const ServiceCapability& service) {
    return HeldByAll(service.name, service.description, service.confirmation_message,
                     service.state_key);
  }
  static std::size_t Held(const SensorCapability& sensor) {
    return HeldByAll(sensor.key, sensor.label, sensor.unit);
  }
  static std::size_t Held(const SettingDescriptor& setting) {
    return HeldByAll(setting.key, setting.label, setting.default_value);
  }
  static std::size_t Held(const UiCapabilities& body) {
    return HeldByAll(body.services, body.sensors, body.settings);
  }
  static std::size_t Held(const SettingUpdate& update) {
    return HeldByAll(update.key, update.value);
  }
  static std::size_t Held(const CurrentSettings& body) { return Held(body.settings); }

  static std::size_t Held(const SensorReading& reading) {
    return HeldByAll(reading.key, reading.value);
  }
  static std::size_t Held(const TelemetryExtras& body) { return Held(body.kv); }

  static std::size_t Held(const SystemHealth& body) { return Held(body.device_id); }
  static std::size_t Held(const ConsumableStatus& body) {
    return HeldByAll(body.kind, body.tank_id, body.unit);
  }
  static std::size_t Held(const SpatialDirectiveStatus& body) { return Held(body.directive_id); }
  static std::size_t Held(const AgentInfo& body) {
    return HeldByAll(body.agent_version, body.software_version, body.os_info);
  }

  static std::size_t Held(const MissionRunStatus& body) {
    return HeldByAll(body.mission_id, body.run_id, body.status_message, body.current_path_id,
                     body.name);
  }

  static std::size_t Held(const Fault& body) {
    return HeldByAll(body.fault_id, body.source, body.category, body.description,
                     body.suggested_action);
  }
  static std::size_t Held(const MissionStartedEvent& event) { return Held(event.mission_id); }
  static std::size_t Held(const MissionCompletedEvent& event) { return Held(event.mission_id); }
  static std::size_t Held(const FaultRaisedEvent& event) {
    return HeldByAll(event.fault_code, event.description);
  }
  static std::size_t Held(const FaultClearedEvent& event) { return Held(event.fault_code); }
  static std::size_t Held(const NamedEvent& event) {
    return HeldByAll(event.kind, event.detail_json);
  }
  static std::size_t Held(const EventTelemetry& body) { return Held(body.kind); }
  static std::size_t Held(const Message& body) {
    return HeldByAll(body.message, body.detail_json, body.source_level);
  }

  static std::size_t Held(const AssetIdentity& identity) {
    return HeldByAll(identity.id, identity.name, identity.hash);
  }
  static std::size_t Held(const MultiPoint& data) { return Held(data.points); }
  static std::size_t Held(const LineString& data) { return Held(data.points); }
  static std::size_t Held(const MultiLineString& data) { return Held(data.lines); }
  static std::size_t Held(const PolygonData& data) { return HeldByAll(data.exterior, data.holes); }
  static std::size_t Held(const MultiPolygon& data) { return Held(data.polygons); }
  static std::size_t Held(const ReportedShape& shape) {
    return HeldByAll(shape.identity, shape.data);
  }
  static std::size_t Held(const Deletion& deletion) { return Held(deletion.id); }
  static std::size_t Held(const ShapeOp& body) { return Held(body.op); }
  static std::size_t Held(const Object& object) { return HeldByAll(object.id, object.name); }
  static std::size_t Held(const ObjectOp& body) { return Held(body.op); }

  static std::size_t Held(const FuelStatus& fuel) {
    return HeldByAll(fuel.volume_unit, fuel.efficiency_unit);
  }
  static std::size_t Held(const EStop& estop) { return Held(estop.ids); }
  static std::size_t Held(const StatusTelemetry& body) {
    return HeldByAll(body.estop, body.status, body.fuel);
  }

  static std::size_t Held(const RcanJoint& joint) { return Held(joint.joint); }
  static std::size_t Held(const RcanState& state) {
    return HeldByAll(state.joints, state.clock_source);
  }

  static std::size_t Held(const Rejection& rejection) {
    return HeldByAll(rejection.field, rejection.detail);
  }

  template <uncrew::Listed T>
  static std::size_t Held(const T& body) {
    return std::apply([&](const auto&... field) { return HeldByAll(body.*field.member...); },
                      uncrew::kFields<T>);
  }

  template <typename T>
  static std::size_t Held(const std::optional<T>& value) {
    return value ? Held(*value) : 0;
  }

  template <typename... T>
  static std::size_t Held(const std::variant<T...>& value) {
    return std::visit([](const auto& alternative) { return Held(alternative); }, value);
  }

  template <typename T>
  static std::size_t Held(const std::vector<T>& values) {
    std::size_t held = Allocated(values.capacity() * sizeof(T));
    if constexpr (!std::is_trivially_copyable_v<T>) {
      for (const T& value : values) held += Held(value);
    }
    return held;
  }
};

}  // namespace

std::size_t HeldBytes(const Body& body) { return Counter::Held(body); }

std::size_t HeldBytes(const Record& record) {
  std::size_t held = Counter::Held(record.body());
  for (const DroppedField& field : record.dropped()) held += sizeof(field) + Counter::Held(field);
  return held;
}

std::size_t HeldBytes(const Rejection& rejection) { return Counter::Held(rejection); }

std::size_t HeldBytes(const ScopeUpdate& update) {
  return Counter::HeldByAll(update.id, update.type, update.detail_json);
}

std::size_t HeldBytes(const OperatorRequest& request) {
  return Counter::HeldByAll(request.request_id, request.text);
}

std::size_t HeldBytes(const std::string& text) { return Counter::Held(text); }

std::size_t HeldBytes(const Value& value) { return Counter::Held(value); }

std::size_t HeldBytes(const MotionTelemetry& motion) { return Counter::Held(motion); }

std::size_t HeldBytes(const StatusTelemetry& status) { return Counter::Held(status); }

std::size_t HeldBytes(const SystemHealth& health) { return Counter::Held(health); }

std::size_t HeldBytes(const UsageTelemetry& usage) { return Counter::Held(usage); }

std::size_t HeldBytes(const ConsumableStatus& status) { return Counter::Held(status); }

std::size_t HeldBytes(const SpatialDirectiveStatus& status) { return Counter::Held(status); }

std::size_t HeldBytes(const RcanState& state) { return Counter::Held(state); }

std::size_t HeldBytes(const uncrew::Value& value) { return Counter::Held(value); }

}  // namespace uplink::model
