#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace uplink::forward {

/// How much memory the shared set takes, in all, per fleet and per reporting robot, and whose items
/// were left out. Each fleet has a share, so that none fills the others' room. If a fleet or
/// everything is full, robots that take most give way to those that take little.
///
/// Bound: robots with left-out items, which are no more than robots with items.
/// Thread: bytes and left_out from any; the rest on one thread.
class Shares final {
 public:
  struct Limits {
    std::size_t bytes_max = 0;
    std::size_t fleet_bytes_max = 0;
    std::size_t robot_bytes_max = 0;
  };
  /// The owner of an item.
  struct Holder {
    const std::string& ruri;
    const std::string& fleet;
  };
  struct OwnedHolder {
    std::string ruri;
    std::string fleet;
  };
  explicit Shares(const Limits& limits) : limits_(limits) {}

  /// Changes an item of the robot from `before` to `after` bytes. False, and nothing changes, if
  /// there is no room.
  [[nodiscard]] bool Resize(const Holder& holder, std::size_t before, std::size_t after);
  /// Whose items must go to make room for an item that Resize refused: if the fleet is full, those
  /// of its largest robot; otherwise those of the largest robot of the largest fleet. Empty if the
  /// asking robot exceeds its own share, or the other does not take twice as much: so two robots
  /// never push each other out in turns.
  [[nodiscard]] std::optional<OwnedHolder> ChooseToGiveWay(const Holder& holder, std::size_t before,
                                                           std::size_t after) const;
  /// False if an item of the robot of this size, or more, can have no room at all.
  [[nodiscard]] bool MayFit(const Holder& holder, std::size_t bytes) const;
  /// The robot that takes most of the fleet's room; empty if none takes any.
  [[nodiscard]] std::string MostOf(const std::string& fleet) const;
  /// An item of the robot was left out.
  void NoteLeftOut(const Holder& holder);
  /// One of the robot's items went, or found room: fewer left-out items may be missing now.
  void NoteChanged(const std::string& ruri);
  /// Begins to look at the items of one robot, or of all, which notes left-out items again. Earlier
  /// ones count until EndLook.
  void BeginLook(const std::string& ruri);
  void BeginLookAtAll();
  void EndLook();
  /// The look was cut short: its robots must be looked at again.
  void BreakOffLook();
  /// Robots whose left-out items may have room now: the robot gave some back or changed an item
  /// since; or any robot did, if the fleet or everything was full.
  [[nodiscard]] std::vector<std::string> DueForLook() const;
  /// Robots with left-out items, each with the robot that takes most of its fleet.
  [[nodiscard]] std::map<std::string, std::string> robots_left_out() const;

  [[nodiscard]] std::size_t bytes_max() const { return limits_.bytes_max; }
  [[nodiscard]] std::size_t bytes() const { return bytes_.load(); }
  /// How often items were left out, since the last look at them.
  [[nodiscard]] std::size_t left_out() const { return left_out_.load(); }

 private:
  struct LeftOut;
  void NoteRoom(const std::string& ruri);
  static void Begin(LeftOut& left_out);

  /// One fleet's use.
  struct Fleet {
    std::size_t bytes = 0;
    std::map<std::string, std::size_t> robots;
    /// The same robots by bytes.
    std::set<std::pair<std::size_t, std::string>> by_bytes;
  };
  /// Bytes of the robot, of its fleet and of all.
  struct Taken {
    std::size_t robot = 0;
    std::size_t fleet = 0;
    std::size_t all = 0;
  };
  [[nodiscard]] Taken TakenBy(const Holder& holder) const;
  [[nodiscard]] bool Fits(const Taken& taken) const {
    return taken.robot <= limits_.robot_bytes_max && taken.fleet <= limits_.fleet_bytes_max &&
           taken.all <= limits_.bytes_max;
  }
  void Set(const Holder& holder, const Taken& taken);

  const Limits limits_;
  /// Fleets with items.
  std::map<std::string, Fleet> fleets_;
  struct LeftOut {
    std::string fleet;
    std::size_t times = 0;
    /// The count of the look before, while one is under way.
    std::size_t before = 0;
    /// Its fleet or everything was full, not the robot's own share.
    bool for_others = false;
    bool to_look_at = false;
  };
  std::map<std::string, LeftOut> robots_left_out_;
  std::atomic<std::size_t> bytes_{0};
  std::atomic<std::size_t> left_out_{0};
};

}  // namespace uplink::forward
