#include "server/forward/frames.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "schema/base/check.h"
#include "schema/json/read.h"
#include "schema/nexus_command/encode.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::forward {
namespace {

EncodedFrame Encoded(const v1::Forward& forward) {
  v1::RelayResponse frame;
  *frame.mutable_forward() = forward;
  return std::make_shared<const std::string>(frame.SerializeAsString());
}

EncodedFrame Mark(v1::ForwardKind kind) {
  v1::Forward forward;
  forward.set_kind(kind);
  return Encoded(forward);
}

EncodedFrame Command(const std::string& origin, std::string command) {
  v1::Forward forward;
  forward.set_kind(v1::FORWARD_KIND_COMMAND);
  forward.set_origin_ruri(origin);
  forward.set_nexus_command(std::move(command));
  return Encoded(forward);
}

absl::StatusOr<model::ReportedShape> ReportedOf(const storage::ShapeRow& row) {
  auto geometry = json::ReadGeometry(row.geometry_json);
  if (!geometry.ok()) return geometry.status();
  return model::ReportedShape{.identity = row.identity,
                              .data = *std::move(geometry),
                              .area_type = row.area_type,
                              .scope = row.scope,
                              .expire_time_ms = row.expires_at_ms,
                              .min_z_m = row.min_z_m,
                              .max_z_m = row.max_z_m,
                              .level_id = row.level_id};
}

absl::StatusOr<model::Object> ReportedOf(const storage::ObjectRow& row) {
  model::Object object{.id = row.id,
                       .name = row.name,
                       .unix_time_ms = row.sampled_at_ms,
                       .expires_unix_time_ms = row.expires_at_ms,
                       .scope = row.scope,
                       .object_type = row.object_type,
                       .radius_m = row.radius_m};
  auto location = json::ReadPose(row.location_json);
  if (!location.ok()) return location.status();
  object.location = *location;
  if (row.trajectory_json.empty()) return object;
  auto trajectory = json::ReadTrajectory(row.trajectory_json);
  if (!trajectory.ok()) return trajectory.status();
  object.trajectory = *trajectory;
  return object;
}

nexus_command::ItemKind KindOf(storage::PresentKind kind) {
  switch (kind) {
    case storage::PresentKind::kShape:
      return nexus_command::ItemKind::kShape;
    case storage::PresentKind::kObject:
      return nexus_command::ItemKind::kObject;
    case storage::PresentKind::kFault:
      break;
  }
  CheckFailed(__FILE__, __LINE__, "ItemNumberOf(kind)", "the key of an item");
}

}  // namespace

EncodedFrame SnapshotBegin() { return Mark(v1::FORWARD_KIND_SNAPSHOT_BEGIN); }

EncodedFrame SnapshotEnd() { return Mark(v1::FORWARD_KIND_SNAPSHOT_END); }

absl::StatusOr<EncodedFrame> UpsertFrame(const storage::SharedItem& item,
                                         const nexus_command::CommandId& command) {
  const std::string& origin = item.robot().ruri;
  return std::visit(
      [&](const auto& row) -> absl::StatusOr<EncodedFrame> {
        const auto reported = ReportedOf(row);
        if (!reported.ok()) return reported.status();
        return Command(origin, nexus_command::EncodeUpsert(command, *reported, origin));
      },
      item.row);
}

std::size_t LeastFrameBytes(const storage::SharedItem& item) {
  const auto* const shape = std::get_if<storage::ShapeRow>(&item.row);
  if (shape == nullptr) return 0;
  // One bracket per position, and some around them, take less than half of 16 bytes per position.
  constexpr std::size_t kBytesPerBracket = 8;
  return kBytesPerBracket * static_cast<std::size_t>(std::ranges::count(shape->geometry_json, '['));
}

EncodedFrame DeleteFrame(const ItemKey& key, const nexus_command::CommandId& command) {
  return Command(key.ruri,
                 nexus_command::EncodeDelete(command, KindOf(key.kind), key.id, key.ruri));
}

}  // namespace uplink::forward
