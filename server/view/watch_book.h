#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "server/log/rate_limited.h"
#include "server/view/watch_marks.h"
#include "server/view/watched_robots.h"
#include "server/view/watches.h"

namespace uplink::view {

/// About how many bytes of robots are kept between two sweeps for watches that show the same ones.
inline constexpr std::size_t kSharedBytesMax = 32UL * 1024 * 1024;

/// What Watches and each Watch share: the robots, the marks of each watch, and the robots that
/// were shown since the last sweep.
///
/// Thread: as Watches and Watch.
class WatchBook final {
 public:
  /// One watch.
  struct Entry {
    Entry(WatchQuery asked, std::function<void()> wake, SteadyTime now)
        : query(std::move(asked)), ready(std::move(wake)), began(now), filter(query.filter) {}

    const WatchQuery query;
    const std::function<void()> ready;
    const SteadyTime began;
    // Under the book's lock.
    FilteredRobots filter;
    WatchMarks marks;
    /// Its last Take returned nothing.
    bool waiting = false;
    /// Since when it has something to take, or when it last took.
    SteadyTime taken_at{};
    /// Changes that its reader took.
    std::uint64_t taken = 0;
    absl::Status over = absl::OkStatus();
  };

  explicit WatchBook(const Watches::Context& context)
      : context_(context), ends_(context.logger), robots_(context.fleet) {}
  WatchBook(const WatchBook&) = delete;
  WatchBook& operator=(const WatchBook&) = delete;

  [[nodiscard]] absl::StatusOr<std::shared_ptr<Entry>> Begin(WatchQuery query,
                                                             std::function<void()> ready);
  [[nodiscard]] absl::StatusOr<std::vector<WatchChange>> Take(Entry& watch);
  void End(const std::shared_ptr<Entry>& watch, WatchEnd why);
  void Sweep();
  void Stop();
  [[nodiscard]] std::size_t size() const;

 private:
  /// What one Take found, and what became of it.
  struct TakeResult {
    std::vector<WatchChange> changes;
    /// Robots by number that are not shared yet.
    std::vector<std::pair<std::size_t, fleet::RobotPtr>> missing;
    std::uint64_t sweep = 0;
  };
  struct SharedKey {
    std::size_t robot = 0;
    std::size_t parts = 0;
    friend bool operator==(const SharedKey&, const SharedKey&) = default;
    template <typename H>
    friend H AbslHashValue(H hash, const SharedKey& key) {
      return H::combine(std::move(hash), key.robot, key.parts);
    }
  };
  struct HashOfKey {
    std::size_t operator()(const SharedKey& key) const;
  };

  [[nodiscard]] absl::Status RoomFor(const WatchQuery& query) const;
  // Under the lock.
  void Collect(Entry& watch, TakeResult& result);
  void Finish(Entry& watch, const std::vector<RobotShown>& made, TakeResult& result);
  void Share(const SharedKey& key, const RobotShown& robot);
  [[nodiscard]] bool AnyLooks() const;
  static void Mark(Entry& watch, const WatchedRobots::Seen& robot);
  /// Ends the watch if its reader takes nothing; true if that must be woken.
  [[nodiscard]] bool MustWake(Entry& watch, SteadyTime now);

  const Watches::Context context_;
  log::RateLimited ends_;
  mutable std::mutex mutex_;
  bool stopped_ = false;
  WatchedRobots robots_;
  /// Those that are not over.
  std::list<std::shared_ptr<Entry>> watches_;
  /// Sweeps so far. What was shown before one may be older than what it found.
  std::uint64_t sweeps_ = 0;
  std::unordered_map<SharedKey, RobotShown, HashOfKey> shared_;
  std::size_t shared_bytes_ = 0;
};

}  // namespace uplink::view
