#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/uplink-fleet/robot/forward_reader.h"
#include "tools/uplink-fleet/robot/forwarded_item.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::synthetic {

/// An item that a robot holds, and the fingerprint of its contents.
using HeldItem = std::pair<ItemRef, std::uint64_t>;

/// What one robot holds of the shapes and objects of others, by the frames that it got. What the
/// server may not do is a violation: it is counted, and the table goes on.
///
/// Thread: confined to the robot's thread, as `reader`, which outlives the table.
/// Source: docs/integrate/forwarding.md.
class ForwardTable final {
 public:
  ForwardTable(std::string ruri, ForwardReader& reader)
      : ruri_(std::move(ruri)), reader_(&reader) {}

  /// A new stream: a snapshot must come first. What is held stays until that is whole.
  void BeginStream();
  void Take(const v1::Forward& forward);

  [[nodiscard]] const std::string& ruri() const { return ruri_; }
  /// This stream's first snapshot was whole.
  [[nodiscard]] bool whole() const { return whole_; }
  /// What is held, in no order.
  [[nodiscard]] std::vector<HeldItem> Held() const { return {held_.begin(), held_.end()}; }
  /// Commands that came outside snapshots.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }
  /// Snapshots that were whole.
  [[nodiscard]] std::uint64_t snapshots() const { return snapshots_; }
  [[nodiscard]] std::uint64_t violations() const { return violations_; }
  /// Empty: none.
  [[nodiscard]] const std::string& first_violation() const { return first_violation_; }

 private:
  void TakeCommand(const v1::Forward& forward);
  void Violated(std::string rule);

  std::string ruri_;
  ForwardReader* reader_;
  ItemMap<std::uint64_t> held_;
  /// The snapshot that is coming.
  std::optional<ItemMap<std::uint64_t>> coming_;
  bool whole_ = false;
  std::uint64_t changes_ = 0;
  std::uint64_t snapshots_ = 0;
  std::uint64_t violations_ = 0;
  std::string first_violation_;
};

}  // namespace uplink::synthetic
