#include "tests/simulation/shared_book.h"

#include <chrono>
#include <utility>

#include "schema/base/check.h"
#include "schema/nexus_command/decode.h"
#include "schema/nexus_command/encode.h"
#include "storage/expiry.h"
#include "storage/shared_items.h"

namespace uplink::simulation {
namespace {

/// No run is so long.
constexpr std::chrono::hours kRunMax{1};

/// As a robot reads the command that says it.
SharedWhat AsTold(const std::string& bytes) {
  auto command = nexus_command::Decode(bytes);
  UPLINK_CHECK(command.ok(), command.status().ToString());
  if (auto* shape = std::get_if<nexus_command::Shape>(&command->what)) return std::move(*shape);
  return std::get<model::Object>(std::move(command->what));
}

}  // namespace

std::string ToText(const SharedKey& key) { return (key.is_object ? "object " : "shape ") + key.id; }

void SharedBook::Note(const storage::CommitRecord& record) {
  const auto* good = std::get_if<model::Record>(&record.content);
  if (good == nullptr) return;
  const model::RobotId& robot = *record.robot;
  if (const auto* shape = std::get_if<model::ShapeOp>(&good->body())) {
    Version version{.received_at = record.received_at};
    if (const model::ReportedShape* upsert = shape->upsert()) {
      version.expires_ms = upsert->expire_time_ms;
      if (storage::IsShared(upsert->scope)) {
        version.what = AsTold(nexus_command::EncodeUpsert({}, *upsert, robot.ruri));
      }
    }
    Add(robot, {false, nexus_command::ForwardedId(shape->id(), robot.ruri)}, std::move(version));
  } else if (const auto* object = std::get_if<model::ObjectOp>(&good->body())) {
    Version version{.received_at = record.received_at};
    if (object->upsert() != nullptr) {
      model::Object upsert = *object->upsert();
      upsert.expires_unix_time_ms =
          storage::ExpiryOf(upsert, record.received_at, storage::StoreRules());
      version.expires_ms = upsert.expires_unix_time_ms;
      if (storage::IsShared(upsert.scope)) {
        version.what = AsTold(nexus_command::EncodeUpsert({}, upsert, robot.ruri));
      }
    }
    Add(robot, {true, nexus_command::ForwardedId(object->id(), robot.ruri)}, std::move(version));
  }
}

void SharedBook::Add(const model::RobotId& robot, const SharedKey& key, Version version) {
  Item& item = items_[key];
  item.ruri = robot.ruri;
  version.note = ++notes_;
  version.fleet = robot.fleet;
  item.versions.push_back(std::move(version));
}

void SharedBook::NoteRemoval(const std::string& ruri) {
  ++notes_;
  for (auto& [key, item] : items_) {
    if (item.ruri == ruri) item.versions.push_back({.note = notes_});
  }
}

bool SharedBook::IsFor(const Receiver& receiver, const Item& item) {
  const Version& last = item.versions.back();
  return last.what && last.fleet == receiver.fleet && item.ruri != receiver.ruri;
}

SharedBook::Table SharedBook::PresentFor(const Receiver& receiver, SystemTime now) const {
  Table table;
  for (const auto& [key, item] : items_) {
    const Version& last = item.versions.back();
    if (!IsFor(receiver, item) || storage::IsExpired(last.expires_ms, UnixMs(now))) continue;
    table.emplace(key, *last.what);
  }
  return table;
}

std::optional<SharedKey> SharedBook::LackingOf(const Receiver& receiver, const Table& table) const {
  for (const auto& [key, item] : items_) {
    const Version& last = item.versions.back();
    if (!IsFor(receiver, item) || last.note > life_began_) continue;
    if (storage::IsExpired(last.expires_ms, UnixMs(last.received_at + kRunMax))) continue;
    if (!table.contains(key)) return key;
  }
  return std::nullopt;
}

std::optional<std::size_t> SharedBook::VersionOf(const SharedKey& key, const SharedWhat& what,
                                                 std::size_t from) const {
  const auto item = items_.find(key);
  if (item == items_.end()) return std::nullopt;
  for (std::size_t at = from; at < item->second.versions.size(); ++at) {
    if (item->second.versions[at].what == what) return at;
  }
  return std::nullopt;
}

}  // namespace uplink::simulation
