# What goes to a robot, generation 0.1: the payload of every Forward of kind COMMAND is one
# NexusCommand in standard stream framing. Names, ordinals and types are those of the published wire
# format and never change. Conventions and shared types: uplink.capnp.
@0x80becc851735442e;

using Cxx = import "/capnp/c++.capnp";
$Cxx.namespace("uplink::wire");

using Uplink = import "uplink.capnp";

struct NexusCommand {
  id @0 :Data;  # 16 raw bytes of a UUID
  command @1 :InternalCommand;
}

# We build `feature` and `object` alone. The other members keep their numbers, and the type of the
# first one keeps the union's tag where robots look for it: setMode is an enumeration, which takes
# bits 0 to 16 of the data section, so the tag lies in bits 16 to 32. Were it Void, the tag would
# lie in bits 0 to 16.
struct InternalCommand {
  union {
    setMode @0 :Uplink.RobotMode;
    goTo @1 :GoToCmd;
    velocityCmd @2 :VelocityCmd;
    stop @3 :Void;
    resume @4 :Void;
    invokeService @5 :InvokeServiceCmd;
    setMissionRunStatus @6 :SetMissionRunStatusCmd;
    missionCommand @7 :MissionCommand;
    feature @8 :FeatureOp;
    object @9 :Uplink.ObjectOp;
    settingUpdate @10 :List(Uplink.SettingUpdate);
    deleteMission @11 :DeleteMissionCmd;
    spatialDirective @12 :SpatialDirectiveOp;
    teleopJoy @13 :TeleopJoy;
  }
}

# ---- Shapes

# Numbers 10 to 16 are those of ReportedLayerRole plus 10.
enum LayerRole {
  allowedArea @0;
  preferred @1;
  keepout @2;
  softExclusion @3;
  workArea @4;
  target @5;
  queue @6;
  controlZone @7;
  triggerZone @8;
  unused9 @9;
  coverage @10;
  occupied @11;
  reserved @12;
  consumed @13;
  hazard @14;
  blocked @15;
  plannedPath @16;
}

# ReportedShape without an expiry: when that comes, robots get a delete.
struct Shape {
  identity @0 :Uplink.AssetIdentity;
  data @1 :Uplink.ShapeData;
  areaType @2 :LayerRole;
  scope @3 :Uplink.ScopeType;
  minZM @4 :Float64;  # metres; both 0: no vertical bounds
  maxZM @5 :Float64;  # metres
  levelId @6 :Int32;
}

struct SpatialFeature {
  union {
    shape @0 :Shape;
    route @1 :Route;
  }
}

struct FeatureOp {
  union {
    upsert @0 :SpatialFeature;
    delete @1 :Text;  # the feature's id
  }
}

# ---- Structs that we neither build nor read; what they hold is left open

struct Route {}
struct GoToCmd {}
struct VelocityCmd {}
struct InvokeServiceCmd {}
struct SetMissionRunStatusCmd {}
struct MissionCommand {}
struct DeleteMissionCmd {}
struct SpatialDirectiveOp {}
struct TeleopJoy {}
