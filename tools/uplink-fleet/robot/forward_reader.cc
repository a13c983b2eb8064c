#include "tools/uplink-fleet/robot/forward_reader.h"

#include <utility>
#include <variant>

#include "schema/nexus_command/decode.h"

namespace uplink::synthetic {
namespace {

using nexus_command::ItemKind;

ItemRef Item(ItemKind kind, const std::string& id) {
  return std::make_shared<const ItemName>(ItemName{kind, id});
}

// One for each kind of command: the compiler finds the one that is missing.
ReadCommand ReadOf(const nexus_command::Shape& what) {
  return {.item = Item(ItemKind::kShape, what.identity.id), .fingerprint = FingerprintOf(what)};
}
ReadCommand ReadOf(const model::Object& what) {
  return {.item = Item(ItemKind::kObject, what.id), .fingerprint = FingerprintOf(what)};
}
ReadCommand ReadOf(const nexus_command::ShapeDeletion& what) {
  return {.item = Item(ItemKind::kShape, what.id), .deletion = true};
}
ReadCommand ReadOf(const nexus_command::ObjectDeletion& what) {
  return {.item = Item(ItemKind::kObject, what.id), .deletion = true};
}

ReadCommand Decoded(const std::string& bytes) {
  const auto command = nexus_command::Decode(bytes);
  if (!command.ok()) return {.error = std::string(command.status().message())};
  return std::visit([](const auto& what) { return ReadOf(what); }, command->what);
}

}  // namespace

const ReadCommand& ForwardReader::Read(const v1::Forward& forward) {
  const auto known = known_.find(forward.nexus_command());
  if (known != known_.end()) return known->second;
  if (known_.size() >= kReadCommandsMax) known_.clear();
  origins_.insert(forward.origin_ruri());
  return known_.emplace(forward.nexus_command(), Decoded(forward.nexus_command())).first->second;
}

}  // namespace uplink::synthetic
