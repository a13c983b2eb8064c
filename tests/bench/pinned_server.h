#pragma once

#include <memory>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "tests/bench/world.h"
#include "tests/support/server_process.h"
#include "tools/uplink-fleet/report/process_use.h"

namespace uplink::bench {

/// A program on the servers' core. It ends with the object, or with the thread that started it,
/// however that ends.
[[nodiscard]] std::unique_ptr<testing::ServerProcess> StartPinned(
    std::vector<std::string> command, const std::vector<std::string>& environment = {});
/// CPU and memory so far; of one that ended what the kernel still knows.
[[nodiscard]] synthetic::ProcessUse UseOf(const testing::ServerProcess& process);

/// An uplinkd of any build, on the servers' core.
///
/// Errors: that it does not start, or ends by itself, is a value.
/// Thread: confined to the thread that started it, which must outlive it.
class PinnedServer final {
 public:
  struct Options {
    std::string program;
    /// `UPLINKD_...=`
    std::vector<std::string> environment = {};
    /// Descriptors that it may have open; 0: as many as this process.
    int descriptors_max = 0;
  };
  /// Waits until it listens, at most half a minute.
  ///
  /// Errors: kUnavailable with its log.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<PinnedServer>> Start(
      const testing::UplinkdFolder& folder, const Options& options);

  [[nodiscard]] const testing::Ports& ports() const { return ports_; }
  [[nodiscard]] synthetic::ProcessUse use() const { return UseOf(*process_); }
  /// It has ended by itself.
  [[nodiscard]] bool ended() const;
  /// Reads its log, so that it need not wait for a reader. Call it every second or so.
  void ReadLog();
  /// The log as read so far.
  [[nodiscard]] const std::string& log() const { return process_->text(); }
  /// Ends it, if need be by force: how it ended. With a lot still to write that may take some
  /// seconds.
  [[nodiscard]] std::string Stop();

 private:
  explicit PinnedServer(std::unique_ptr<testing::ServerProcess> process)
      : process_(std::move(process)) {}

  std::unique_ptr<testing::ServerProcess> process_;
  testing::Ports ports_;
};

}  // namespace uplink::bench
