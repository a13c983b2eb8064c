#include <string>
#include <string_view>

#include "schema/model/enum_text.h"
#include "server/view/messages.h"
#include "server/view/timestamps.h"

// What is there now: mission runs, shapes, objects.
namespace uplink::view {
namespace {

std::string_view ToText(storage::RunClosed closed) {
  switch (closed) {
    case storage::RunClosed::kNot:
      return "";
    case storage::RunClosed::kForBound:
      return "bound";
    case storage::RunClosed::kForAge:
      return "age";
  }
  return "";
}

}  // namespace

v1::MissionRun ToMessage(const storage::MissionRunRow& row) {
  v1::MissionRun run;
  run.set_ruri(row.robot.ruri);
  run.set_mission_id(row.mission_id);
  run.set_run_id(row.run_id);
  run.set_name(row.name);
  run.set_status(model::EnumText(row.status));
  SetTime(run, &v1::MissionRun::mutable_first_received_at, row.first_received_at);
  SetTime(run, &v1::MissionRun::mutable_last_received_at, row.last_received_at);
  run.set_updates(Signed(row.updates));
  run.set_closed_why(std::string(ToText(row.closed)));
  SetTimeMs(run, &v1::MissionRun::mutable_closed_at, row.closed_at_ms);
  return run;
}

TextMembers TextsOf(const storage::MissionRunRow& row) {
  TextMembers texts;
  texts.AddStored("latest", row.latest_json);
  return texts;
}

v1::OperatorRequest ToMessage(const storage::OperatorRequestRow& row) {
  v1::OperatorRequest request;
  request.set_ruri(row.robot.ruri);
  request.set_request_id(row.request_id);
  request.set_kind(std::string(model::ToText(row.kind)));
  request.set_text(row.text);
  SetTimeMs(request, &v1::OperatorRequest::mutable_requested_at, row.requested_at_ms);
  SetTime(request, &v1::OperatorRequest::mutable_opened_at, row.opened_at);
  SetTimeMs(request, &v1::OperatorRequest::mutable_closed_at, row.closed_at_ms);
  return request;
}

v1::Shape ToMessage(const storage::ShapeRow& row) {
  v1::Shape shape;
  shape.set_ruri(row.robot.ruri);
  shape.set_id(row.identity.id);
  shape.set_name(row.identity.name);
  shape.set_area_type(model::EnumText(row.area_type));
  shape.set_scope(model::EnumText(row.scope));
  shape.set_rev(row.identity.rev);
  shape.set_hash(row.identity.hash);
  SetTimeMs(shape, &v1::Shape::mutable_expires_at, row.expires_at_ms);
  shape.set_min_z_m(row.min_z_m);
  shape.set_max_z_m(row.max_z_m);
  shape.set_level_id(row.level_id);
  SetTime(shape, &v1::Shape::mutable_received_at, row.received_at);
  return shape;
}

TextMembers TextsOf(const storage::ShapeRow& row) {
  TextMembers texts;
  texts.AddStored("geometry", row.geometry_json);
  return texts;
}

v1::TrackedObject ToMessage(const storage::ObjectRow& row) {
  v1::TrackedObject object;
  object.set_ruri(row.robot.ruri);
  object.set_id(row.id);
  object.set_name(row.name);
  object.set_object_type(model::EnumText(row.object_type));
  object.set_scope(model::EnumText(row.scope));
  object.set_radius_m(row.radius_m);
  SetTimeMs(object, &v1::TrackedObject::mutable_sampled_at, row.sampled_at_ms);
  SetTimeMs(object, &v1::TrackedObject::mutable_expires_at, row.expires_at_ms);
  SetTime(object, &v1::TrackedObject::mutable_received_at, row.received_at);
  return object;
}

TextMembers TextsOf(const storage::ObjectRow& row) {
  TextMembers texts;
  texts.AddStored("location", row.location_json);
  if (!row.trajectory_json.empty()) texts.AddStored("trajectory", row.trajectory_json);
  return texts;
}

}  // namespace uplink::view
