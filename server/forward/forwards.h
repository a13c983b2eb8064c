#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "schema/nexus_command/command.h"
#include "server/forward/fleet_items.h"
#include "server/forward/limits.h"
#include "server/forward/shares.h"
#include "server/session/forward_source.h"

namespace uplink::forward {

/// The items that all fleets share, and their receivers. The set follows the store: its reader
/// calls Put and Remove.
///
/// Thread: Join and sums from any; the set's own calls from one thread at a time.
class Forwards final : public session::ForwardSource {
 public:
  /// `random` draws the numbers of commands; it is called on the set's thread alone.
  Forwards(const Shares::Limits& limits, std::function<std::uint64_t()> random,
           const ReceiverLimits& receivers = {});

  // session::ForwardSource
  [[nodiscard]] std::unique_ptr<session::ForwardReceiver> Join(const model::RobotId& robot,
                                                               loop::StreamRef stream) override;

  /// Makes the frame of an item, with the number of its command. Null if it cannot be forwarded.
  using Encode = std::function<EncodedFrame(const nexus_command::CommandId& command)>;
  /// What is known of an item before its frame is made. A value.
  struct Facts {
    const std::string& fleet;
    /// Unix milliseconds; 0: never.
    std::int64_t expires_ms = 0;
    std::size_t least_bytes = 0;
  };
  /// Adds or replaces the item in this fleet. Forwards nothing if no robot would see a difference.
  /// If there is no room, the item is left out and removed. Returns the bytes that receivers will
  /// get. A new item's frame is made only if `least_bytes`, its least size, may have room.
  std::size_t Put(const ItemKey& key, const Facts& facts, const Encode& encode);
  /// Removes the item, if it is there. Returns the bytes that receivers will get.
  std::size_t Remove(const ItemKey& key);
  /// The item's new content follows by a later Put. Until then the old content stays, if it is in
  /// this fleet, and expires at the new time; in another fleet it is removed.
  void Postpone(const ItemKey& key, const std::string& fleet, std::int64_t expires_ms);
  /// Everything that the store holds was put: snapshots may begin.
  void SetWhole();
  /// Removes what expired at or before then.
  void Expire(SystemTime now);
  /// Wakes the receivers for which something began to wait since the last call. Returns how many
  /// wakes that took: a receiver that looked meanwhile may get two.
  std::size_t WakeReceivers();
  /// Keys of all items.
  [[nodiscard]] std::vector<ItemKey> Keys() const;
  /// Something is left out for lack of room. Any thread.
  [[nodiscard]] bool left_out() const { return shares_.left_out() > 0; }
  /// The shares of room that robots and fleets take.
  [[nodiscard]] Shares& shares() { return shares_; }
  /// Whether SetWhole was called. Any thread.
  [[nodiscard]] bool whole() const {
    const std::lock_guard lock(mutex_);
    return whole_;
  }

  /// Sums over all fleets, each fleet as of one moment.
  struct Sum {
    Counts counts;
    /// Changes that wait for their receivers.
    std::uint64_t waiting = 0;
    std::size_t items = 0;
    std::size_t bytes = 0;
    std::size_t receivers = 0;
    /// Receivers whose snapshot is not over, or did not begin.
    std::size_t snapshots_open = 0;
    /// How often items were left out for lack of room, since their robots' items were last read.
    std::size_t left_out = 0;
    bool whole = false;
  };
  [[nodiscard]] Sum sum() const;
  /// Receiving robots that fell so far behind since the last call that they get a new snapshot,
  /// each with the robot from which most items waited; the first kOverflowsToldMax of each fleet.
  [[nodiscard]] std::map<std::string, std::string> TakeOverflowed();
  [[nodiscard]] std::size_t bytes_max() const { return shares_.bytes_max(); }

 private:
  using FleetRef = std::shared_ptr<FleetItems>;
  class Receiver;

  void NoteToWake(const std::vector<loop::StreamRef>& streams);
  /// Notes the streams to wake, and returns the bytes that they get of the frame.
  std::size_t NoteFannedOut(const FleetItems::FannedOut& out, std::size_t frame_bytes);
  std::size_t PutNew(const ItemKey& key, const Facts& facts, const Encode& encode);
  /// Makes room for an item of the robot that takes `after` in place of `before`, if need be by
  /// removing items of those that take most.
  [[nodiscard]] bool TakeRoom(const Shares::Holder& holder, std::size_t before, std::size_t after);
  /// Removes one item of the robot, and notes it as left out. False if there is none.
  bool LeaveOutOne(const Shares::OwnedHolder& holder);
  [[nodiscard]] FleetRef FleetOf(const std::string& name);
  [[nodiscard]] std::vector<FleetRef> Fleets() const;
  [[nodiscard]] nexus_command::CommandId NewCommand() const;

  const SnapshotMarks marks_;
  const ReceiverLimits receiver_limits_;
  const std::function<std::uint64_t()> random_;
  mutable std::mutex mutex_;
  bool whole_ = false;
  /// Every fleet that a certificate or a row has named since the start; the authority that signs
  /// certificates bounds them.
  std::map<std::string, FleetRef> fleets_;

  // Of the set's thread.
  struct Where {
    std::string fleet_name;
    FleetRef fleet;
    nexus_command::CommandId command{};
    /// The bytes that the item counts.
    std::size_t bytes = 0;
  };
  std::map<ItemKey, Where> where_;
  /// Streams to wake; one that looks meanwhile may be here twice.
  std::vector<loop::StreamRef> to_wake_;
  Shares shares_;
};

}  // namespace uplink::forward
