#include "tests/component/uplinkd/forwarding.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "schema/base/check.h"
#include "schema/encode.h"
#include "schema/nexus_command/decode.h"

namespace uplink::testing {
namespace {

/// Reports of one frame.
constexpr std::size_t kBatch = 100;

/// The id that a command names, and whether the item is there after it.
struct Named {
  std::string id;
  bool there = false;
};

Named NameIn(const nexus_command::Command& command) {
  struct Visitor {
    Named operator()(const nexus_command::Shape& shape) const { return {shape.identity.id, true}; }
    Named operator()(const model::Object& object) const { return {object.id, true}; }
    Named operator()(const nexus_command::ShapeDeletion& gone) const { return {gone.id, false}; }
    Named operator()(const nexus_command::ObjectDeletion& gone) const { return {gone.id, false}; }
  };
  return std::visit(Visitor{}, command.what);
}

v1::RelayRequest HelloOf(std::uint8_t session, bool declines) {
  v1::RelayRequest hello = HelloFrame(SessionOf(session));
  hello.mutable_hello()->set_declines_forwards(declines);
  return hello;
}

}  // namespace

std::string SharingRuri(std::string_view name) {
  return "rcan://local.rcan/test/share/1.0/" + std::string(name);
}

model::ReportedShape SharedShape(const std::string& id, model::ScopeType scope) {
  return {.identity = {.id = id, .name = "name of " + id, .rev = 3, .hash = "hash"},
          .data = model::PolygonData{.exterior = {{1, 2}, {3, 2}, {3, 4}, {1, 2}}, .holes = {}},
          .area_type = model::ReportedLayerRole::kHazard,
          .scope = scope,
          .min_z_m = -1,
          .max_z_m = 2.5,
          .level_id = 4};
}

model::Object SharedObject(const std::string& id, double lat_deg) {
  model::Object object;
  object.id = id;
  object.name = "name of " + id;
  object.scope = model::ScopeType::kWorld;
  object.object_type = model::ObjectType::kAnimal;
  object.location.lat_deg = lat_deg;
  object.radius_m = 1.5;
  return object;
}

SharingRobot::SharingRobot(const std::shared_ptr<grpc::Channel>& channel, std::uint8_t session,
                           bool declines)
    : agent_(channel) {
  UPLINK_CHECK(agent_.Send(HelloOf(session, declines)), "a hello goes out");
  const auto welcome = agent_.Read();
  UPLINK_CHECK(welcome && welcome->has_welcome(), "a robot is welcomed");
  last_seq_ = welcome->welcome().committed_seq();
  settled_ = last_seq_;
}

void SharingRobot::Report(const model::Body& body) {
  Queue(body);
  UPLINK_CHECK(Settle(), "a report is settled");
}

void SharingRobot::Queue(const model::Body& body) {
  queued_.push_back({++last_seq_, schema::Encode(body)});
  if (queued_.size() == kBatch) Flush();
}

void SharingRobot::Flush() {
  if (queued_.empty()) return;
  UPLINK_CHECK(agent_.Send(BatchFrame(queued_)), "reports go out");
  queued_.clear();
}

bool SharingRobot::Settle() {
  Flush();
  while (settled_ < last_seq_) {
    if (!ReadOne()) return false;
  }
  return true;
}

bool SharingRobot::ReadOne() {
  const auto frame = agent_.Read();
  if (!frame) return false;
  if (frame->has_ack()) settled_ = std::max(settled_, frame->ack().through_seq());
  if (frame->has_forward()) Apply(frame->forward());
  return true;
}

void SharingRobot::Apply(const v1::Forward& forward) {
  ++forwards_;
  switch (forward.kind()) {
    case v1::FORWARD_KIND_SNAPSHOT_BEGIN:
      UPLINK_CHECK(!snapshot_, "one snapshot at a time");
      snapshot_.emplace();
      return;
    case v1::FORWARD_KIND_SNAPSHOT_END:
      UPLINK_CHECK(snapshot_.has_value(), "what ends has begun");
      table_ = *std::exchange(snapshot_, std::nullopt);
      ++snapshots_;
      return;
    default:
      break;
  }
  auto command = nexus_command::Decode(forward.nexus_command());
  UPLINK_CHECK(command.ok(), std::string(command.status().message()));
  const Named named = NameIn(*command);
  origins_[named.id] = forward.origin_ruri();
  auto& table = snapshot_ ? *snapshot_ : table_;
  if (named.there) {
    table[named.id] = *command;
  } else {
    UPLINK_CHECK(table.erase(named.id) == 1, "what is deleted was held: " + named.id);
  }
  last_ = *std::move(command);
}

bool SharingRobot::ReadUntilHolds(std::vector<std::string> ids) {
  std::ranges::sort(ids);
  while (snapshot_ || snapshots_ == 0 || held() != ids) {
    if (!ReadOne()) return false;
  }
  return true;
}

bool SharingRobot::ReadSnapshot() {
  const std::size_t before = snapshots_;
  while (snapshots_ == before) {
    if (!ReadOne()) return false;
  }
  return true;
}

std::optional<nexus_command::Command> SharingRobot::ReadCommand() {
  last_.reset();
  while (!last_) {
    if (!ReadOne()) return std::nullopt;
  }
  return last_;
}

std::vector<std::string> SharingRobot::held() const {
  std::vector<std::string> ids;
  for (const auto& [id, command] : table_) ids.push_back(id);
  return ids;
}

const nexus_command::Command* SharingRobot::At(const std::string& id) const {
  const auto place = table_.find(id);
  return place == table_.end() ? nullptr : &place->second;
}

}  // namespace uplink::testing
