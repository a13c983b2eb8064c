#include "tests/simulation/forward_table.h"

#include <utility>

#include <absl/strings/match.h>

#include "schema/nexus_command/decode.h"

namespace uplink::simulation {
namespace {

SharedKey KeyOf(const nexus_command::Shape& shape) { return {false, shape.identity.id}; }
SharedKey KeyOf(const model::Object& object) { return {true, object.id}; }
SharedKey KeyOf(const nexus_command::ShapeDeletion& gone) { return {false, gone.id}; }
SharedKey KeyOf(const nexus_command::ObjectDeletion& gone) { return {true, gone.id}; }

}  // namespace

void ForwardTable::OnForward(const v1::Forward& forward) {
  switch (forward.kind()) {
    case v1::FORWARD_KIND_SNAPSHOT_BEGIN:
      return Begin();
    case v1::FORWARD_KIND_SNAPSHOT_END:
      return End();
    case v1::FORWARD_KIND_COMMAND:
      return OnCommand(forward);
    default:
      violation_("a Forward of no kind");
  }
}

void ForwardTable::Begin() {
  if (state_ == State::kSnapshot) violation_("a snapshot began within a snapshot");
  state_ = State::kSnapshot;
  snapshot_.clear();
}

void ForwardTable::End() {
  if (state_ != State::kSnapshot) violation_("a snapshot ended that had not begun");
  state_ = State::kFollows;
  held_ = std::exchange(snapshot_, {});
  if (const auto key = book_.LackingOf(self_, held_)) {
    violation_("a snapshot lacks " + ToText(*key) + ", which was there all the time");
  }
}

void ForwardTable::OnCommand(const v1::Forward& forward) {
  if (state_ == State::kNoneYet) violation_("a command came before the first snapshot");
  auto command = nexus_command::Decode(forward.nexus_command());
  if (!command.ok()) return violation_("a command: " + std::string(command.status().message()));
  const SharedKey key = std::visit([](const auto& what) { return KeyOf(what); }, command->what);
  CheckOrigin(forward, key);
  std::visit([&](auto& what) { Apply(key, std::move(what)); }, command->what);
}

void ForwardTable::CheckOrigin(const v1::Forward& forward, const SharedKey& key) const {
  const std::string& origin = forward.origin_ruri();
  if (!absl::EndsWith(key.id, "@" + origin)) violation_(ToText(key) + " came as of " + origin);
  if (origin == self_.ruri) violation_("its own " + ToText(key) + " came back");
  // The simulated robots bear their fleet in their names.
  if (!absl::StartsWith(origin, "rcan://" + self_.fleet + "/")) {
    violation_(ToText(key) + " came from another fleet");
  }
}

void ForwardTable::Upsert(const SharedKey& key, SharedWhat what) {
  std::size_t& version = versions_[key];
  const auto told = book_.VersionOf(key, what, version);
  if (!told) {
    violation_(ToText(key) + " was never committed so, or went back to an earlier state");
  }
  version = told.value_or(version);
  SharedBook::Table& table = state_ == State::kSnapshot ? snapshot_ : held_;
  table.insert_or_assign(key, std::move(what));
}

void ForwardTable::Delete(const SharedKey& key) {
  if (state_ == State::kSnapshot) violation_("a snapshot has the end of " + ToText(key));
  if (held_.erase(key) == 0) violation_(ToText(key) + " ended, and was not there");
}

}  // namespace uplink::simulation
