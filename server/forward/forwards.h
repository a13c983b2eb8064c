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

/// What all fleets share, and who receives it. The set follows what the store holds: whoever reads
/// it there calls Put and Remove.
///
/// Thread: Join from any thread, sums too; the set's own calls from one thread at a time.
class Forwards final : public session::ForwardSource {
 public:
  /// `random` draws the numbers of commands; it is called on the set's thread alone.
  Forwards(const Shares::Limits& limits, std::function<std::uint64_t()> random,
           const ReceiverLimits& receivers = {});

  // session::ForwardSource
  [[nodiscard]] std::unique_ptr<session::ForwardReceiver> Join(const model::RobotId& robot,
                                                               loop::StreamRef stream) override;

  /// Makes the frame of an item, with the number of its command. Null: it cannot be forwarded.
  using Encode = std::function<EncodedFrame(const nexus_command::CommandId& command)>;
  /// What is known of an item before its frame is made. A value.
  struct Facts {
    const std::string& fleet;
    /// Unix milliseconds; 0: never.
    std::int64_t expires_ms = 0;
    std::size_t least_bytes = 0;
  };
  /// The item is there, in this fleet. Nothing is forwarded if no robot would see a difference.
  /// Left out, and gone, if there is no room for it. Returns the bytes that receivers are to get.
  /// The frame has at least `least_bytes`: where those have no room it is not made.
  std::size_t Put(const ItemKey& key, const Facts& facts, const Encode& encode);
  /// The item is there no more; nothing if it was not. Returns the bytes that receivers are to get.
  std::size_t Remove(const ItemKey& key);
  /// The item is there, in this fleet, and how it is now is told later: it is in no other fleet any
  /// more, and lives until then.
  void PutOff(const ItemKey& key, const std::string& fleet, std::int64_t expires_ms);
  /// All that the store holds was put: snapshots may begin.
  void SetWhole();
  /// Removes what expired at or before then.
  void Expire(SystemTime now);
  /// Wakes those for whom something waits since the last call, each once for all of it. Returns how
  /// many.
  std::size_t WakeReceivers();
  /// Keys of all that is there.
  [[nodiscard]] std::vector<ItemKey> Keys() const;
  /// Something is left out for lack of room. Any thread.
  [[nodiscard]] bool left_out() const { return shares_.left_out() > 0; }
  /// Whose items are, and the looks at them.
  [[nodiscard]] Shares& shares() { return shares_; }
  /// As of SetWhole. Any thread.
  [[nodiscard]] bool whole() const {
    const std::lock_guard lock(mutex_);
    return whole_;
  }

  /// What all fleets are and did, each as of one moment.
  struct Sum {
    Counts counts;
    /// Changes that wait for their receivers.
    std::uint64_t waiting = 0;
    std::size_t items = 0;
    std::size_t bytes = 0;
    std::size_t receivers = 0;
    /// Receivers whose snapshot is not over, or did not begin.
    std::size_t snapshots_open = 0;
    /// Times that an item was left out for lack of room, since its robot's were read last.
    std::size_t left_out = 0;
    bool whole = false;
  };
  [[nodiscard]] Sum sum() const;
  /// Robots that receive and fell so far behind, since the last call, that they get a new snapshot,
  /// each with the robot of which most waited; the first kOverflowsToldMax of each fleet.
  [[nodiscard]] std::map<std::string, std::string> TakeOverflowed();
  [[nodiscard]] std::size_t bytes_max() const { return shares_.bytes_max(); }

 private:
  using FleetRef = std::shared_ptr<FleetItems>;
  class Receiver;

  void ToWake(const std::vector<loop::StreamRef>& streams);
  /// Wakes those who are to be, and returns the bytes that they get of the frame.
  std::size_t Told(const FleetItems::FannedOut& out, std::size_t frame_bytes);
  std::size_t PutNew(const ItemKey& key, const Facts& facts, const Encode& encode);
  /// Room for an item of the robot that takes `after` in place of `before`, if need be where those
  /// that take most gave way.
  [[nodiscard]] bool TakeRoom(const Shares::Holder& holder, std::size_t before, std::size_t after);
  /// One item of the robot goes, and is left out. False if there is none.
  bool GiveWay(const Shares::OwnedHolder& holder);
  [[nodiscard]] FleetRef FleetOf(const std::string& name);
  [[nodiscard]] std::vector<FleetRef> Fleets() const;
  [[nodiscard]] nexus_command::CommandId NewCommand() const;

  const SnapshotMarks marks_;
  const ReceiverLimits receiver_limits_;
  const std::function<std::uint64_t()> random_;
  mutable std::mutex mutex_;
  bool whole_ = false;
  /// Every fleet that a certificate or a row named since the start: who signs certificates decides
  /// how many there are.
  std::map<std::string, FleetRef> fleets_;

  // Of the set's thread.
  struct Where {
    std::string fleet_name;
    FleetRef fleet;
    nexus_command::CommandId command{};
    /// What the item counts for.
    std::size_t bytes = 0;
  };
  std::map<ItemKey, Where> where_;
  /// Streams that are to be woken; one that looks meanwhile may be here twice.
  std::vector<loop::StreamRef> to_wake_;
  Shares shares_;
};

}  // namespace uplink::forward
