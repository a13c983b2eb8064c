#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "tools/uplink-fleet/robot/forwarded_item.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::synthetic {

/// Commands that a ForwardReader remembers; at it all are forgotten.
inline constexpr std::size_t kReadCommandsMax = 8192;

/// What one command says.
struct ReadCommand {
  /// Why it says nothing; empty if it does.
  std::string error{};
  ItemRef item{};
  /// The item has ended; else it is what the fingerprint stands for.
  bool deletion = false;
  std::uint64_t fingerprint = 0;
};

/// Reads each command once for all robots of a thread: the server sends the same bytes to each, and
/// a fleet of thousands could not decode them thousands of times.
///
/// Thread: confined to its thread.
class ForwardReader final {
 public:
  /// Valid until the next call.
  [[nodiscard]] const ReadCommand& Read(const v1::Forward& forward);

  /// The robots that commands came from.
  [[nodiscard]] const std::set<std::string>& origins() const { return origins_; }

 private:
  /// By the serialized command.
  std::unordered_map<std::string, ReadCommand> known_;
  std::set<std::string> origins_;
};

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
