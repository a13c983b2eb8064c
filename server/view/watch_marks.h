#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace uplink::view {

/// A set of small numbers. A value.
class NumberSet final {
 public:
  void Add(std::size_t number);
  /// Whether it was there.
  bool Remove(std::size_t number);
  /// The lowest from `first` on.
  [[nodiscard]] std::optional<std::size_t> NextFrom(std::size_t first) const;
  [[nodiscard]] bool empty() const { return size_ == 0; }

 private:
  static constexpr std::size_t kBits = 64;

  std::vector<std::uint64_t> words_;
  std::size_t size_ = 0;
};

/// What one watch has still to be shown: robots by number, never their contents. A robot is shown
/// as it is when its number is taken, however often it changed before; the numbers are taken in
/// circles, so that robots that change often keep no other one from its turn.
///
/// Limits: two bits per robot, and the RURI of each robot that was shown and is gone.
/// Thread: confined to its owner's lock.
class WatchMarks final {
 public:
  /// The robot matches, and is new or has changed.
  void Show(std::size_t robot) { due_.Add(robot); }
  /// It does not match, or is gone. Its number may be another robot's from now on.
  void Hide(std::size_t robot, std::string_view ruri);

  /// A robot is gone that was shown; nothing if there is none.
  [[nodiscard]] std::optional<std::string> TakeRemoved();
  /// The next robot to show; nothing if none is due.
  [[nodiscard]] std::optional<std::size_t> TakeRobot();
  /// The robot was taken and not shown: it is the next one.
  void PutBack(std::size_t robot);
  /// Once, when all robots of the first circle were taken: how many.
  [[nodiscard]] std::optional<std::int64_t> TakeSnapshotEnd();

  /// Whether there is something to take.
  [[nodiscard]] bool any() const { return in_snapshot_ || !due_.empty() || !removed_.empty(); }

 private:
  NumberSet due_;
  NumberSet shown_;
  /// In the order in which they went.
  std::vector<std::string> removed_;
  /// Where the circle goes on.
  std::size_t next_ = 0;
  bool in_snapshot_ = true;
  std::int64_t in_first_circle_ = 0;
};

}  // namespace uplink::view
