#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/fleet/fleet.h"
#include "server/view/glance.h"
#include "storage/reader.h"

namespace uplink::view {

/// How old the glances at robots of other processes may be before they are read again, and before
/// they no longer count.
inline constexpr std::chrono::seconds kForeignEvery{10};
inline constexpr std::chrono::seconds kForeignAgeMax{60};
/// Robots of one question to the store.
inline constexpr std::size_t kForeignAtOnce = 500;

/// What the store has of robots that other processes hold. A value.
struct ForeignRead {
  storage::Reader::LiveRows live;
  /// The agentInfos of the same robots.
  std::vector<storage::LatestRow> infos;
};
/// Asks for `ruris`, which ascend, at least one, and waits. The first `live.complete` of them were
/// looked at. Errors: of the reader.
[[nodiscard]] absl::StatusOr<ForeignRead> ReadForeign(storage::Reader& reader,
                                                      std::span<const std::string> ruris);

/// Glances at the robots that other processes hold, from what those keep in the store: that has the
/// live parts of streams, but neither those of twins and drones nor connections.
///
/// Limits: one glance per robot of the fleet.
/// Thread: thread-safe.
class ForeignGlances final {
 public:
  /// All of them outlive it.
  struct Context {
    const Clock& clock;
    const fleet::Fleet& fleet;
    storage::Reader& reader;
  };
  explicit ForeignGlances(const Context& context) : context_(context) {}

  /// Whether it is time to read them; never if no other process holds a robot.
  [[nodiscard]] bool due() const;
  /// Reads them, and waits for the store. Errors: of the reader; the last ones stay.
  [[nodiscard]] absl::Status Read();
  /// Never null. A robot that is not in it is unknown.
  [[nodiscard]] std::shared_ptr<const GlanceMap> glances() const;

 private:
  [[nodiscard]] std::vector<std::string> Foreign() const;

  const Context context_;
  mutable std::mutex mutex_;
  std::shared_ptr<const GlanceMap> glances_ = std::make_shared<const GlanceMap>();
  SteadyTime read_at_{};
};

}  // namespace uplink::view
