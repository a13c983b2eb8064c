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

/// How much memory the shared set takes, as a whole, per fleet and per robot that reported it, and
/// whose items were left out for that. A fleet has a share, so that none fills the room of others;
/// and where a fleet or all are full, who takes most gives way to who takes little.
///
/// Bound:  robots of which items were left out; there are no more than robots with items.
/// Thread: bytes and left_out from any; the rest on one thread.
class Shares final {
 public:
  struct Limits {
    std::size_t bytes_max = 0;
    std::size_t fleet_bytes_max = 0;
    std::size_t robot_bytes_max = 0;
  };
  /// Whose an item is.
  struct Holder {
    const std::string& ruri;
    const std::string& fleet;
  };
  struct OwnedHolder {
    std::string ruri;
    std::string fleet;
  };
  explicit Shares(const Limits& limits) : limits_(limits) {}

  /// An item of the robot takes `after` bytes in place of `before`. False, and nothing changes, if
  /// there is no room for more.
  [[nodiscard]] bool Resize(const Holder& holder, std::size_t before, std::size_t after);
  /// Whose items are to go so that an item of the robot, which Resize refused, has room: the robot
  /// that takes most of its fleet or, where all are full, of the fleet that takes most. Nothing if
  /// the robot is over its own share, or that one does not take twice as much as it: so nobody
  /// pushes out whoever pushed it out.
  [[nodiscard]] std::optional<OwnedHolder> WhoGivesWay(const Holder& holder, std::size_t before,
                                                       std::size_t after) const;
  /// False: an item of the robot that takes this, or more, has no room in any case.
  [[nodiscard]] bool MayFit(const Holder& holder, std::size_t bytes) const;
  /// The robot that takes most of the fleet; empty if none takes any.
  [[nodiscard]] std::string MostOf(const std::string& fleet) const;
  /// An item of the robot was left out.
  void NoteLeftOut(const Holder& holder);
  /// One of the robot's items went, or found room: of what was left out of them less may be missing
  /// by now.
  void NoteChanged(const std::string& ruri);
  /// The items of one robot, or of all, are looked at again, and what is left out of them is noted
  /// anew. What was left out before counts until EndLook: it is not there yet.
  void BeginLook(const std::string& ruri);
  void BeginLookAtAll();
  void EndLook();
  /// The look did not come to its end: what it was for is to be looked at again.
  void BreakOffLook();
  /// The robots of which items were left out that may be there by now: the robot, or where its
  /// fleet or all is full anybody, gave some room back since, or an item of it changed.
  [[nodiscard]] std::vector<std::string> ToLookAtAgain() const;
  /// Those of which items are left out, each with the robot that takes most of its fleet.
  [[nodiscard]] std::map<std::string, std::string> robots_left_out() const;

  [[nodiscard]] std::size_t bytes_max() const { return limits_.bytes_max; }
  [[nodiscard]] std::size_t bytes() const { return bytes_.load(); }
  /// Times that an item was left out, since the last look at it.
  [[nodiscard]] std::size_t left_out() const { return left_out_.load(); }

 private:
  struct LeftOut;
  void NoteRoom(const std::string& ruri);
  static void Begin(LeftOut& left_out);

  /// Of one fleet.
  struct Fleet {
    std::size_t bytes = 0;
    std::map<std::string, std::size_t> robots;
    /// The same by what they take.
    std::set<std::pair<std::size_t, std::string>> by_bytes;
  };
  /// What the robot, its fleet and all take.
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
  /// Those that have any.
  std::map<std::string, Fleet> fleets_;
  struct LeftOut {
    std::string fleet;
    std::size_t times = 0;
    /// Those of the look before, while one is under way.
    std::size_t before = 0;
    /// For want of room of its fleet or of all, not of the robot's own.
    bool for_others = false;
    bool to_look_at = false;
  };
  std::map<std::string, LeftOut> robots_left_out_;
  std::atomic<std::size_t> bytes_{0};
  std::atomic<std::size_t> left_out_{0};
};

}  // namespace uplink::forward
