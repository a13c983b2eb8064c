#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>

#include "schema/model/spatial.h"
#include "schema/nexus_command/command.h"
#include "tests/simulation/shared_book.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::simulation {

/// What a modelled agent holds of the others' shapes and objects. It follows the protocol, and
/// checks what the server promises of forwards.
class ForwardTable final {
 public:
  using Violation = std::function<void(const std::string&)>;
  ForwardTable(SharedBook::Receiver self, const SharedBook& book, Violation violation)
      : self_(std::move(self)), book_(book), violation_(std::move(violation)) {}

  /// A new stream: what is held stays until its first snapshot is over.
  void OnStream() { state_ = State::kNoneYet; }
  void OnForward(const v1::Forward& forward);

  /// A snapshot of this stream is over, and none is under way.
  [[nodiscard]] bool complete() const { return state_ == State::kFollows; }
  [[nodiscard]] const SharedBook::Table& held() const { return held_; }
  [[nodiscard]] const SharedBook::Receiver& self() const { return self_; }

 private:
  enum class State : std::uint8_t { kNoneYet, kSnapshot, kFollows };

  void Begin();
  void End();
  void OnCommand(const v1::Forward& forward);
  // One for each kind of command: the compiler finds the one that is missing.
  void Apply(const SharedKey& key, nexus_command::Shape what) { Upsert(key, std::move(what)); }
  void Apply(const SharedKey& key, model::Object what) { Upsert(key, std::move(what)); }
  void Apply(const SharedKey& key, const nexus_command::ShapeDeletion&) { Delete(key); }
  void Apply(const SharedKey& key, const nexus_command::ObjectDeletion&) { Delete(key); }
  void Upsert(const SharedKey& key, SharedWhat what);
  void Delete(const SharedKey& key);
  void CheckOrigin(const v1::Forward& forward, const SharedKey& key) const;

  const SharedBook::Receiver self_;
  const SharedBook& book_;
  const Violation violation_;
  State state_ = State::kNoneYet;
  SharedBook::Table held_;
  /// Of the snapshot that has begun.
  SharedBook::Table snapshot_;
  /// The version of each item that was told last: it never goes back.
  std::map<SharedKey, std::size_t> versions_;
};

}  // namespace uplink::simulation
