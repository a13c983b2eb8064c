#include <type_traits>
#include <variant>

#include "schema/encode/encode_body.h"

namespace uplink::schema {
namespace {

using PositionsBuilder = capnp::List<wire::GeoPoint2>::Builder;

unsigned Count(const auto& items) { return static_cast<unsigned>(items.size()); }

/// Writes one event kind; one overload an alternative.
struct KindEncoder {
  wire::EventKind::Builder out;

  void operator()(const model::EstopEngagedEvent&) { out.setEstopEngaged(); }
  void operator()(const model::EstopReleasedEvent&) { out.setEstopReleased(); }
  void operator()(const model::ModeChangedEvent& in) {
    auto event = out.initModeChanged();
    event.setFrom(Enum<wire::RobotMode>(in.from));
    event.setTo(Enum<wire::RobotMode>(in.to));
  }
  void operator()(const model::MissionStartedEvent& in) {
    out.initMissionStarted().setMissionId(Text(in.mission_id));
  }
  void operator()(const model::MissionCompletedEvent& in) {
    out.initMissionCompleted().setMissionId(Text(in.mission_id));
  }
  void operator()(const model::FaultRaisedEvent& in) {
    auto event = out.initFaultRaised();
    event.setFaultCode(Text(in.fault_code));
    event.setDescription(Text(in.description));
  }
  void operator()(const model::FaultClearedEvent& in) {
    out.initFaultCleared().setFaultCode(Text(in.fault_code));
  }
};

void EncodePositions(const model::Positions& in, PositionsBuilder out) {
  for (unsigned i = 0; i < out.size(); ++i) {
    out[i].setLon(in[i].lon);
    out[i].setLat(in[i].lat);
  }
}

void EncodeLines(const std::vector<model::Positions>& in,
                 capnp::List<capnp::List<wire::GeoPoint2>>::Builder out) {
  for (unsigned i = 0; i < out.size(); ++i) EncodePositions(in[i], out.init(i, Count(in[i])));
}

void EncodePolygon(const model::PolygonData& in, wire::PolygonData::Builder out) {
  EncodePositions(in.exterior, out.initExterior(Count(in.exterior)));
  EncodeLines(in.holes, out.initHoles(Count(in.holes)));
}

/// Writes one geometry; one overload an alternative.
struct GeometryEncoder {
  wire::ShapeData::Builder out;

  void operator()(const model::GeoPoint2& in) {
    auto point = out.initPoint();
    point.setLon(in.lon);
    point.setLat(in.lat);
  }
  void operator()(const model::MultiPoint& in) {
    EncodePositions(in.points, out.initMultiPoint(Count(in.points)));
  }
  void operator()(const model::LineString& in) {
    EncodePositions(in.points, out.initLineString(Count(in.points)));
  }
  void operator()(const model::MultiLineString& in) {
    EncodeLines(in.lines, out.initMultiLineString(Count(in.lines)));
  }
  void operator()(const model::PolygonData& in) { EncodePolygon(in, out.initPolygon()); }
  void operator()(const model::MultiPolygon& in) {
    auto polygons = out.initMultiPolygon(Count(in.polygons));
    for (unsigned i = 0; i < polygons.size(); ++i) EncodePolygon(in.polygons[i], polygons[i]);
  }
};

void EncodeShape(const model::ReportedShape& in, wire::ReportedShape::Builder out) {
  auto identity = out.initIdentity();
  identity.setId(Text(in.identity.id));
  identity.setName(Text(in.identity.name));
  identity.setRev(in.identity.rev);
  identity.setHash(Text(in.identity.hash));
  std::visit(GeometryEncoder{out.initData()}, in.data);
  out.setAreaType(Enum<wire::ReportedLayerRole>(in.area_type));
  out.setScope(Enum<wire::ScopeType>(in.scope));
  out.setExpireTimeMs(in.expire_time_ms);
  out.setMinZM(in.min_z_m);
  out.setMaxZM(in.max_z_m);
  out.setLevelId(in.level_id);
}

void EncodeObject(const model::Object& in, wire::Object::Builder out) {
  out.setId(Text(in.id));
  out.setName(Text(in.name));
  out.setUnixTimeMs(in.unix_time_ms);
  out.setExpiresUnixTimeMs(in.expires_unix_time_ms);
  out.setScope(Enum<wire::ScopeType>(in.scope));
  out.setObjectType(Enum<wire::ObjectType>(in.object_type));
  EncodePose(in.location, out.initLocation());
  if (in.trajectory) {
    auto trajectory = out.initTrajectory();
    trajectory.setSpeedMps(in.trajectory->speed_mps);
    trajectory.setCourseDeg(in.trajectory->course_deg);
    trajectory.setVerticalRateMps(in.trajectory->vertical_rate_mps);
  }
  out.setRadiusM(in.radius_m);
}

void EncodeService(const model::ServiceCapability& in, wire::ServiceCapability::Builder out) {
  out.setName(Text(in.name));
  out.setDescription(Text(in.description));
  out.setCapabilityType(Enum<wire::CapabilityType>(in.capability_type));
  out.setHasConfirmationMessage(in.confirmation_message.has_value());
  if (in.confirmation_message) out.setConfirmationMessage(Text(*in.confirmation_message));
  out.setStateKey(Text(in.state_key));
  out.setRequiresRole(Enum<wire::Role>(in.requires_role));
  out.setDangerLevel(Enum<wire::DangerLevel>(in.danger_level));
}

void EncodeSensor(const model::SensorCapability& in, wire::SensorCapability::Builder out) {
  out.setKey(Text(in.key));
  out.setLabel(Text(in.label));
  out.setValueType(Enum<wire::ValueType>(in.value_type));
  out.setUnit(Text(in.unit));
  out.setHasRange(in.range.has_value());
  if (in.range) {
    out.setRangeMin(in.range->min);
    out.setRangeMax(in.range->max);
  }
  out.setDisplayHint(Enum<wire::DisplayHint>(in.display_hint));
}

void EncodeSetting(const model::SettingDescriptor& in, wire::SettingDescriptor::Builder out) {
  out.setKey(Text(in.key));
  out.setLabel(Text(in.label));
  out.setValueType(Enum<wire::ValueType>(in.value_type));
  EncodeValue(in.default_value, out.initDefault());
  out.setHasRange(in.range.has_value());
  if (in.range) {
    auto range = out.initRange();
    range.setMin(in.range->min);
    range.setMax(in.range->max);
  }
  out.setHasStep(in.step.has_value());
  out.setStep(in.step.value_or(0));
}

}  // namespace

void EncodeValue(const model::Value& in, wire::Value::Builder out) {
  std::visit(
      [&](const auto& value) {
        using T = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<T, std::string>) {
          out.setString(Text(value));
        } else if constexpr (std::is_same_v<T, std::int32_t>) {
          out.setInt(value);
        } else if constexpr (std::is_same_v<T, double>) {
          out.setNumber(value);
        } else if constexpr (std::is_same_v<T, bool>) {
          out.setBool(value);
        } else {
          static_assert(std::is_same_v<T, model::EnumName>);
          out.setEnum(Text(value.name));
        }
      },
      in);
}

void EncodeMember(const model::MissionRunStatus& in, wire::UplinkMsg::Builder message) {
  auto out = message.initMissionRunStatus();
  out.setUnixTimeMs(in.unix_time_ms);
  out.setMissionId(Text(in.mission_id));
  out.setRunId(Text(in.run_id));
  out.setStatus(Enum<wire::MissionStatus>(in.status));
  out.setHasStatusMessage(in.status_message.has_value());
  if (in.status_message) out.setStatusMessage(Text(*in.status_message));
  out.setHasProgressX100(in.progress_x100.has_value());
  out.setProgressX100(in.progress_x100.value_or(0));
  out.setHasCurrentPathId(in.current_path_id.has_value());
  if (in.current_path_id) out.setCurrentPathId(Text(*in.current_path_id));
  out.setHasCurrentTarget(in.current_target.has_value());
  if (in.current_target) EncodePose(*in.current_target, out.initCurrentTarget());
  out.setHasCurrentStep(in.current_step.has_value());
  out.setCurrentStep(in.current_step.value_or(0));
  out.setHasTotalSteps(in.total_steps.has_value());
  out.setTotalSteps(in.total_steps.value_or(0));
  out.setHasTimeStartedMs(in.time_started_ms.has_value());
  out.setTimeStartedMs(in.time_started_ms.value_or(0));
  out.setHasExpectedEndTimeMs(in.expected_end_time_ms.has_value());
  out.setExpectedEndTimeMs(in.expected_end_time_ms.value_or(0));
  out.setHasTimeCompletedMs(in.time_completed_ms.has_value());
  out.setTimeCompletedMs(in.time_completed_ms.value_or(0));
  out.setHasName(in.name.has_value());
  if (in.name) out.setName(Text(*in.name));
}

void EncodeMember(const model::EventTelemetry& in, wire::UplinkMsg::Builder message) {
  auto out = message.initEventTelemetry();
  out.setUnixTimeMs(in.unix_time_ms);
  std::visit(KindEncoder{out.initKind()}, in.kind);
}

void EncodeMember(const model::UiCapabilities& in, wire::UplinkMsg::Builder message) {
  auto out = message.initUiCapabilities();
  auto services = out.initServices(Count(in.services));
  for (unsigned i = 0; i < services.size(); ++i) EncodeService(in.services[i], services[i]);
  auto sensors = out.initSensors(Count(in.sensors));
  for (unsigned i = 0; i < sensors.size(); ++i) EncodeSensor(in.sensors[i], sensors[i]);
  auto settings = out.initSettings(Count(in.settings));
  for (unsigned i = 0; i < settings.size(); ++i) EncodeSetting(in.settings[i], settings[i]);
}

void EncodeMember(const model::Fault& in, wire::UplinkMsg::Builder message) {
  auto out = message.initFault();
  out.setUnixTimeMs(in.unix_time_ms);
  out.setFaultId(Text(in.fault_id));
  out.setSource(Text(in.source));
  out.setSeverity(Enum<wire::FaultSeverity>(in.severity));
  out.setActive(in.active);
  out.setCategory(Text(in.category));
  out.setDescription(Text(in.description));
  out.setSuggestedAction(Text(in.suggested_action));
}

void EncodeMember(const model::ShapeOp& in, wire::UplinkMsg::Builder message) {
  auto out = message.initShape();
  if (in.upsert() != nullptr) {
    EncodeShape(*in.upsert(), out.initUpsert());
  } else {
    out.setDelete(Text(in.id()));
  }
}

void EncodeMember(const model::ObjectOp& in, wire::UplinkMsg::Builder message) {
  auto out = message.initObject();
  if (in.upsert() != nullptr) {
    EncodeObject(*in.upsert(), out.initUpsert());
  } else {
    out.setDelete(Text(in.id()));
  }
}

void EncodeMember(const model::CurrentSettings& in, wire::UplinkMsg::Builder message) {
  auto out = message.initCurrentSettings(Count(in.settings));
  for (unsigned i = 0; i < out.size(); ++i) {
    out[i].setKey(Text(in.settings[i].key));
    EncodeValue(in.settings[i].value, out[i].initValue());
  }
}

void EncodeMember(const model::Message& in, wire::UplinkMsg::Builder message) {
  auto out = message.initMessage();
  out.setUnixTimeMs(in.unix_time_ms);
  out.setLevel(Enum<wire::MessageLevel>(in.level));
  out.setMessage(Text(in.message));
}

void EncodeMember(const model::AgentInfo& in, wire::UplinkMsg::Builder message) {
  auto out = message.initAgentInfo();
  out.setAgentVersion(Text(in.agent_version));
  out.setHasSoftwareVersion(in.software_version.has_value());
  if (in.software_version) out.setSoftwareVersion(Text(*in.software_version));
  out.setHasOsInfo(in.os_info.has_value());
  if (in.os_info) out.setOsInfo(Text(*in.os_info));
  out.setHasUptimeS(in.uptime_s.has_value());
  out.setUptimeS(in.uptime_s.value_or(0));
}

}  // namespace uplink::schema
