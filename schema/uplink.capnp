# What a robot's agent sends up, generation 0.1: the payload of every relay envelope is one
# UplinkMsg in standard stream framing. Names, ordinals and types are those of the published wire
# format and never change; another generation is another file.
#
# Conventions that hold at every field:
# - times ending in Ms are Unix milliseconds, UTC; 0 means unknown, for an expiry never;
# - a hasX flag says whether the field beside it means anything;
# - text, list and struct pointers may be null: empty or absent.
@0xad9bf8303f04c2cc;

using Cxx = import "/capnp/c++.capnp";
$Cxx.namespace("uplink::wire");

struct UplinkMsg {
  union {
    missionRunStatus @0 :MissionRunStatus;
    motionTelemetry @1 :MotionTelemetry;
    statusTelemetry @2 :StatusTelemetry;
    telemetryExtras @3 :TelemetryExtras;
    eventTelemetry @4 :EventTelemetry;
    uiCapabilities @5 :UiCapabilities;
    fault @6 :Fault;
    shape @7 :ReportedShapeOp;
    object @8 :ObjectOp;
    systemHealth @9 :SystemHealth;
    usageTelemetry @10 :UsageTelemetry;
    consumableStatus @11 :ConsumableStatus;
    currentSettings @12 :List(SettingUpdate);
    message @13 :Message;
    agentInfo @14 :AgentInfo;
    spatialDirectiveStatus @15 :SpatialDirectiveStatus;
  }
}

# ---- Motion

struct Pose {
  latDeg @0 :Float64;      # degrees, north positive
  lonDeg @1 :Float64;      # degrees, east positive
  altitudeM @2 :Float64;   # metres above the ellipsoid; NaN: not known
  headingDeg @3 :Float64;  # degrees clockwise from north; NaN: not known
}

struct VelTwist {
  linearMps @0 :Float32;   # metres a second
  angularRps @1 :Float32;  # radians a second
}

enum GpsFixType {
  unknown @0;
  invalid @1;
  gps @2;
  dgps @3;
  sbas @4;
  floatRtk @5;
  fixedRtk @6;
  pps @7;
}

enum GpsSource {
  real @0;
  simulated @1;
  estimated @2;
}

struct MotionTelemetry {
  unixTimeMs @0 :Int64;
  pose @1 :Pose;
  hasPose @2 :Bool;
  velocity @3 :VelTwist;
  hasVelocity @4 :Bool;
  gpsFixType @5 :GpsFixType;
  hasGpsFixType @6 :Bool;
  gpsSource @7 :GpsSource;
}

# ---- Status

enum RobotMode {
  manual @0;
  auto @1;
  teleop @2;
  idle @3;
}

enum PowerSupplyStatus {
  unknown @0;
  charging @1;
  discharging @2;
  notCharging @3;
  full @4;
}

enum PowerSupplyHealth {
  unknown @0;
  good @1;
  overheat @2;
  dead @3;
  overvoltage @4;
  unspecifiedFailure @5;
  cold @6;
  watchdogTimerExpire @7;
  safetyTimerExpire @8;
}

enum PowerSupplyTechnology {
  unknown @0;
  niMH @1;
  liIon @2;
  liPo @3;
  liFe @4;
  niCd @5;
  liMn @6;
}

struct BatteryStatus {
  socPct @0 :Float32;            # state of charge, percent
  voltageV @1 :Float32;          # volts
  hasVoltageV @2 :Bool;
  currentA @3 :Float32;          # amperes; NaN: not measured
  hasCurrentA @4 :Bool;
  chargeAh @5 :Float32;          # ampere hours
  hasChargeAh @6 :Bool;
  capacityAh @7 :Float32;        # ampere hours
  hasCapacityAh @8 :Bool;
  designCapacityAh @9 :Float32;  # ampere hours
  hasDesignCapacityAh @10 :Bool;
  temperature @11 :Float32;      # degrees Celsius; NaN: not measured
  hasTemperature @12 :Bool;
  powerSupplyStatus @13 :PowerSupplyStatus;
  powerSupplyHealth @14 :PowerSupplyHealth;
  powerSupplyTechnology @15 :PowerSupplyTechnology;
}

struct FuelStatus {
  levelPct @0 :Float32;         # percent
  volumeRemaining @1 :Float32;  # in volumeUnit
  hasVolumeRemaining @2 :Bool;
  capacity @3 :Float32;         # of the tank, in volumeUnit
  hasCapacity @4 :Bool;
  volumeUnit @5 :Text;
  hasVolumeUnit @6 :Bool;
  efficiency @7 :Float32;       # in efficiencyUnit
  hasEfficiency @8 :Bool;
  efficiencyUnit @9 :Text;
  hasEfficiencyUnit @10 :Bool;
  isRefueling @11 :Bool;
}

struct EStop {
  unixTimeMs @0 :Int64;
  active @1 :Bool;
  ids @2 :List(Text);  # the stops that are engaged
}

struct StatusTelemetry {
  unixTimeMs @0 :Int64;
  battery @1 :BatteryStatus;
  hasBattery @2 :Bool;
  mode @3 :RobotMode;
  hasMode @4 :Bool;
  estop @5 :EStop;
  faulted @6 :Bool;
  missionActive @7 :Bool;  # the robot can accept missions
  status @8 :Text;
  fuel @9 :FuelStatus;
  hasFuel @10 :Bool;
  rangeRemaining @11 :Float64;    # metres
  hasRangeRemaining @12 :Bool;
  runtimeRemaining @13 :Float64;  # seconds
  hasRuntimeRemaining @14 :Bool;
}

# ---- Extras

struct Value {
  union {
    string @0 :Text;
    int @1 :Int32;
    number @2 :Float64;
    bool @3 :Bool;
    enum @4 :Text;
  }
}

struct SensorReading {
  key @0 :Text;
  value @1 :Value;
  unixTimeMs @2 :Int64;
  hasUnixTimeMs @3 :Bool;
}

struct TelemetryExtras {
  unixTimeMs @0 :Int64;
  kv @1 :List(SensorReading);
}

# ---- Missions

enum MissionStatus {
  unknown @0;
  ready @1;
  starting @2;
  running @3;
  paused @4;
  blocked @5;
  aborted @6;
  complete @7;
  error @8;
}

struct MissionRunStatus {
  unixTimeMs @0 :Int64;
  missionId @1 :Text;  # the template; empty for a mission of the robot's own
  runId @2 :Text;
  status @3 :MissionStatus;
  statusMessage @4 :Text;
  hasStatusMessage @5 :Bool;
  progressX100 @6 :UInt16;  # percent times 100
  hasProgressX100 @7 :Bool;
  currentPathId @8 :Text;
  hasCurrentPathId @9 :Bool;
  currentTarget @10 :Pose;
  hasCurrentTarget @11 :Bool;
  currentStep @12 :UInt32;
  hasCurrentStep @13 :Bool;
  totalSteps @14 :UInt32;
  hasTotalSteps @15 :Bool;
  timeStartedMs @16 :Int64;
  hasTimeStartedMs @17 :Bool;
  expectedEndTimeMs @18 :Int64;
  hasExpectedEndTimeMs @19 :Bool;
  timeCompletedMs @20 :Int64;
  hasTimeCompletedMs @21 :Bool;
  name @22 :Text;
  hasName @23 :Bool;
}

# ---- Faults, events, messages

enum FaultSeverity {
  info @0;
  minor @1;
  major @2;
  critical @3;
}

struct Fault {
  unixTimeMs @0 :Int64;
  faultId @1 :Text;
  source @2 :Text;
  severity @3 :FaultSeverity;
  active @4 :Bool;  # raised, or cleared
  category @5 :Text;
  description @6 :Text;
  suggestedAction @7 :Text;
}

struct ModeChangedEvent {
  from @0 :RobotMode;
  to @1 :RobotMode;
}

struct MissionStartedEvent {
  missionId @0 :Text;
}

struct MissionCompletedEvent {
  missionId @0 :Text;
}

struct FaultRaisedEvent {
  faultCode @0 :Text;
  description @1 :Text;
}

struct FaultClearedEvent {
  faultCode @0 :Text;
}

struct EventKind {
  union {
    estopEngaged @0 :Void;
    estopReleased @1 :Void;
    modeChanged @2 :ModeChangedEvent;
    missionStarted @3 :MissionStartedEvent;
    missionCompleted @4 :MissionCompletedEvent;
    faultRaised @5 :FaultRaisedEvent;
    faultCleared @6 :FaultClearedEvent;
  }
}

struct EventTelemetry {
  unixTimeMs @0 :Int64;
  kind @1 :EventKind;
}

enum MessageLevel {
  info @0;
  warn @1;
  error @2;
}

struct Message {
  unixTimeMs @0 :Int64;
  level @1 :MessageLevel;
  message @2 :Text;
}

# ---- Shapes and objects

enum ReportedLayerRole {
  coverage @0;
  occupied @1;
  reserved @2;
  consumed @3;
  hazard @4;
  blocked @5;
  plannedPath @6;
}

# Robot and user stay with the fleet manager; fleet and world go to the fleet's other robots.
enum ScopeType {
  robot @0;
  fleet @1;
  world @2;
  user @3;
}

struct AssetIdentity {
  id @0 :Text;
  name @1 :Text;
  rev @2 :UInt32;  # 0: not provided
  hash @3 :Text;   # empty: not provided
}

struct GeoPoint2 {
  lon @0 :Float64;  # degrees
  lat @1 :Float64;  # degrees
}

struct PolygonData {
  exterior @0 :List(GeoPoint2);
  holes @1 :List(List(GeoPoint2));
}

struct ShapeData {
  union {
    point @0 :GeoPoint2;
    multiPoint @1 :List(GeoPoint2);
    lineString @2 :List(GeoPoint2);
    multiLineString @3 :List(List(GeoPoint2));
    polygon @4 :PolygonData;
    multiPolygon @5 :List(PolygonData);
  }
}

struct ReportedShape {
  identity @0 :AssetIdentity;
  data @1 :ShapeData;
  areaType @2 :ReportedLayerRole;
  scope @3 :ScopeType;
  expireTimeMs @4 :Int64;
  minZM @5 :Float64;  # metres; both 0: no vertical bounds
  maxZM @6 :Float64;  # metres
  levelId @7 :Int32;
}

struct ReportedShapeOp {
  union {
    upsert @0 :ReportedShape;
    delete @1 :Text;  # the shape's id
  }
}

enum ObjectType {
  unknown @0;
  person @1;
  animal @2;
  vehicle @3;
  robot @4;
  structure @5;
  equipment @6;
  obstacle @7;
  debris @8;
  hazard @9;
  marker @10;
  pointOfInterest @11;
}

struct Trajectory {
  speedMps @0 :Float64;         # metres a second
  courseDeg @1 :Float64;        # degrees clockwise from north
  verticalRateMps @2 :Float64;  # metres a second, up positive
}

struct Object {
  id @0 :Text;
  name @1 :Text;
  unixTimeMs @2 :Int64;
  expiresUnixTimeMs @3 :Int64;
  scope @4 :ScopeType;
  objectType @5 :ObjectType;
  location @6 :Pose;
  trajectory @7 :Trajectory;
  radiusM @8 :Float64;  # metres
}

struct ObjectOp {
  union {
    upsert @0 :Object;
    delete @1 :Text;  # the object's id
  }
}

# ---- Health, usage, consumables, directives, agent

struct SystemHealth {
  unixTimeMs @0 :Int64;
  deviceId @1 :Text;
  cpuPct @2 :Float32;          # percent; NaN in any of these: not measured
  memPct @3 :Float32;          # percent
  diskPct @4 :Float32;         # percent
  cpuTemp @5 :Float32;         # degrees Celsius
  signalStrength @6 :Float32;  # RSSI, dBm
  signalQuality @7 :Float32;   # link quality as the host reports it
}

struct UsageTelemetry {
  unixTimeMs @0 :Int64;
  totalDistanceM @1 :Float64;   # metres
  autoDistanceM @2 :Float64;    # metres
  manualDistanceM @3 :Float64;  # metres
  uptimeTotalS @4 :Float64;     # seconds
  driveTimeTotalS @5 :Float64;  # seconds
  autoTimeTotalS @6 :Float64;   # seconds
  missionCountTotal @7 :UInt32;
  chargeCyclesTotal @8 :UInt32;
  rebootCount @9 :UInt32;
  lastRebootUnixTimeMs @10 :Int64;
}

struct ConsumableStatus {
  unixTimeMs @0 :Int64;
  kind @1 :Text;
  tankId @2 :Text;
  levelPct @3 :Float32;         # percent
  amountRemaining @4 :Float32;  # in unit
  unit @5 :Text;
  isCritical @6 :Bool;
}

struct SpatialDirectiveStatus {
  directiveId @0 :Text;
  lastEvalTimeMs @1 :Int64;
  active @2 :Bool;
  insideZone @3 :Bool;
  distanceToZoneM @4 :Float32;  # metres
  hasDistanceToZoneM @5 :Bool;
}

struct AgentInfo {
  agentVersion @0 :Text;
  softwareVersion @1 :Text;
  hasSoftwareVersion @2 :Bool;
  osInfo @3 :Text;
  hasOsInfo @4 :Bool;
  uptimeS @5 :UInt64;  # seconds since boot
  hasUptimeS @6 :Bool;
}

# ---- Capabilities and settings

enum CapabilityType {
  trigger @0;
  setBool @1;
  missionType @2;
}

enum Role {
  viewer @0;
  operator @1;
  admin @2;
  owner @3;
}

enum DangerLevel {
  normal @0;
  warning @1;
  critical @2;
}

enum ValueType {
  string @0;
  int @1;
  number @2;
  bool @3;
  enum @4;
}

enum DisplayHint {
  none @0;
  onOff @1;
  gauge @2;
  text @3;
  online @4;
  warningLight @5;
  temperature @6;
  progress @7;
}

struct ServiceCapability {
  name @0 :Text;
  description @1 :Text;
  capabilityType @2 :CapabilityType;
  confirmationMessage @3 :Text;
  hasConfirmationMessage @4 :Bool;
  stateKey @5 :Text;
  requiresRole @6 :Role;
  dangerLevel @7 :DangerLevel;
}

struct SensorCapability {
  key @0 :Text;
  label @1 :Text;
  valueType @2 :ValueType;
  unit @3 :Text;
  rangeMin @4 :Float64;  # in unit
  rangeMax @5 :Float64;  # in unit
  hasRange @6 :Bool;
  displayHint @7 :DisplayHint;
}

struct Range {
  min @0 :Float64;
  max @1 :Float64;
}

struct SettingDescriptor {
  key @0 :Text;
  label @1 :Text;
  valueType @2 :ValueType;
  default @3 :Value;
  range @4 :Range;
  hasRange @5 :Bool;
  step @6 :Float64;
  hasStep @7 :Bool;
}

struct UiCapabilities {
  services @0 :List(ServiceCapability);
  sensors @1 :List(SensorCapability);
  settings @2 :List(SettingDescriptor);
}

struct SettingUpdate {
  key @0 :Text;
  value @1 :Value;
}
