#include "tools/uplink-fleet/robot/forward_table.h"

#include <variant>

#include <fmt/core.h>

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

void ForwardTable::BeginStream() {
  coming_.reset();
  whole_ = false;
}

void ForwardTable::Violated(std::string rule) {
  if (violations_++ == 0) first_violation_ = std::move(rule);
}

void ForwardTable::Take(const v1::Forward& forward) {
  switch (forward.kind()) {
    case v1::FORWARD_KIND_SNAPSHOT_BEGIN:
      if (coming_) Violated("a snapshot began within a snapshot");
      coming_.emplace();
      return;
    case v1::FORWARD_KIND_SNAPSHOT_END:
      if (!coming_) return Violated("a snapshot ended that had not begun");
      held_ = *std::exchange(coming_, std::nullopt);
      whole_ = true;
      ++snapshots_;
      return;
    case v1::FORWARD_KIND_COMMAND:
      return TakeCommand(forward);
    default:
      return Violated(fmt::format("a Forward of kind {}", static_cast<int>(forward.kind())));
  }
}

void ForwardTable::TakeCommand(const v1::Forward& forward) {
  if (!coming_) {
    ++changes_;
    if (!whole_) Violated("a command came before the stream's first snapshot");
  }
  const ReadCommand& read = reader_->Read(forward);
  if (!read.error.empty()) return Violated(read.error);
  if (!IsOf(*read.item, forward.origin_ruri())) {
    return Violated(fmt::format("{} came as one of {}", Shown(*read.item), forward.origin_ruri()));
  }
  if (forward.origin_ruri() == ruri_) {
    return Violated(fmt::format("{} came back to its origin", Shown(*read.item)));
  }
  if (read.deletion) {
    if (coming_) return Violated(fmt::format("{} ended within a snapshot", Shown(*read.item)));
    if (held_.erase(read.item) == 0) {
      Violated(fmt::format("{} ended, but was never shared", Shown(*read.item)));
    }
    return;
  }
  // What changes while a snapshot comes may stand twice in it.
  ItemMap<std::uint64_t>& items = coming_ ? *coming_ : held_;
  items.insert_or_assign(read.item, read.fingerprint);
}

}  // namespace uplink::synthetic
