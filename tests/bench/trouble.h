#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include <absl/status/statusor.h>

#include "tests/bench/fair/others.h"
#include "tests/bench/pinned_server.h"
#include "tests/bench/world.h"

namespace uplink::bench {

/// What a scenario of trouble is measured on.
struct TroubleRun {
  const World& world;
  std::string server_bin;
  /// Without the trouble, and with it.
  milliseconds window{0};
  /// Well-behaved robots.
  std::size_t robots = 1;
  /// Somebody wants it to end.
  std::function<bool()> stopped;
  /// A line of progress.
  std::function<void(const std::string&)> say;
};

/// An SQLite store of its own for one scenario; its file goes before and after.
class FreshFile final {
 public:
  explicit FreshFile(std::string path) : path_(std::move(path)) { Remove(); }
  ~FreshFile() { Remove(); }
  FreshFile(const FreshFile&) = delete;
  FreshFile& operator=(const FreshFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::string url() const { return "sqlite://" + path_; }

 private:
  void Remove() const;
  const std::string path_;
};

/// The server of a scenario. Its store is migrated, and robots that are silent are seen to be so
/// within a window.
///
/// Errors: kUnavailable with its log.
[[nodiscard]] absl::StatusOr<std::unique_ptr<PinnedServer>> StartServer(
    const TroubleRun& run, const std::string& store_url, int descriptors_max = 0);

/// A server, and the well-behaved robots whose waits are measured.
///
/// Thread: confined to the thread that drives the robots.
class Scene final {
 public:
  /// `run` and `server` outlive it.
  Scene(const TroubleRun& run, PinnedServer& server, Others::Rhythm rhythm)
      : run_(run),
        server_(server),
        others_(loop_, clock_, run.world.LinkTo(server.ports().relay), rhythm) {}

  [[nodiscard]] const Clock& clock() const { return clock_; }
  [[nodiscard]] Others& others() { return others_; }
  /// To be called on each turn of the robots: looks at the server. False where nothing that follows
  /// would mean anything.
  [[nodiscard]] bool Turn();
  /// Turns for so long.
  [[nodiscard]] Others::OnTurn For(milliseconds time);
  /// The most memory that the server was seen with since ForgetMemory.
  [[nodiscard]] double memory_max_mib() const { return memory_max_mib_; }
  void ForgetMemory() { memory_max_mib_ = 0; }

 private:
  const TroubleRun& run_;
  PinnedServer& server_;
  const SystemClock clock_{};
  link::Loop loop_;
  Others others_;
  double memory_max_mib_ = 0;
  SteadyTime log_read_{};
};

/// A line of progress, for people.
void Say(const std::string& text);

inline constexpr double kMiB = 1024.0 * 1024.0;

}  // namespace uplink::bench
