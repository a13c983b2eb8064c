#include "tools/uplink-fleet/robot/forward_reader.h"

#include <type_traits>
#include <utility>
#include <variant>

#include "schema/nexus_command/decode.h"

namespace uplink::synthetic {
namespace {

using nexus_command::ItemKind;

ItemRef Item(ItemKind kind, const std::string& id) {
  return std::make_shared<const ItemName>(ItemName{kind, id});
}

ReadCommand Decoded(const std::string& bytes) {
  const auto command = nexus_command::Decode(bytes);
  if (!command.ok()) return {.error = std::string(command.status().message())};
  return std::visit(
      []<typename What>(const What& what) -> ReadCommand {
        if constexpr (std::is_same_v<What, nexus_command::Shape>) {
          return {.item = Item(ItemKind::kShape, what.identity.id),
                  .fingerprint = FingerprintOf(what)};
        } else if constexpr (std::is_same_v<What, model::Object>) {
          return {.item = Item(ItemKind::kObject, what.id), .fingerprint = FingerprintOf(what)};
        } else if constexpr (std::is_same_v<What, nexus_command::ShapeDeletion>) {
          return {.item = Item(ItemKind::kShape, what.id), .deletion = true};
        } else {
          return {.item = Item(ItemKind::kObject, what.id), .deletion = true};
        }
      },
      command->what);
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
