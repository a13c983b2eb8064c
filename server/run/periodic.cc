#include "server/run/periodic.h"

#include <chrono>
#include <utility>

#include "server/fleet/liveness.h"
#include "server/fleet/top_senders.h"
#include "server/http/token_files.h"
#include "server/transport/options.h"
#include "server/view/fault_counts.h"

namespace uplink::run {
namespace {

constexpr std::chrono::seconds kSweepEvery{1};
constexpr std::chrono::seconds kStoreEvery{1};
constexpr milliseconds kRobotsEvery{500};
constexpr std::chrono::seconds kDronesEvery{1};
constexpr std::chrono::seconds kAuditEvery{1};
/// A change counts at the second look.
constexpr std::chrono::seconds kConfigEvery{2};
/// A third of the unit's WatchdogSec.
constexpr std::chrono::seconds kFeedEvery{10};
/// One short statement. An age of minutes is what counts.
constexpr std::chrono::seconds kSnapshotEvery{10};
/// One call of the kernel and a short statement. Robots may fill some hundred megabytes meanwhile.
constexpr std::chrono::seconds kSpaceEvery{2};
/// How long an operator who confirmed the clock waits at most.
constexpr std::chrono::seconds kClockEvery{5};

}  // namespace

void DoPeriodically(const std::function<void(milliseconds, std::function<void()>)>& every,
                    PeriodicWork work) {
  every(kSweepEvery, std::move(work.sweep));
  every(transport::kFilesRefresh, std::move(work.look_at_certificate));
  every(http::kTokensRefresh, std::move(work.look_at_access));
  every(kStoreEvery, std::move(work.look_at_store));
  every(kRobotsEvery, std::move(work.read_robots));
  every(kSnapshotEvery, std::move(work.ask_for_snapshot));
  every(kSpaceEvery, std::move(work.look_at_space));
  every(kClockEvery, std::move(work.look_at_clock));
  every(view::kFaultCountsEvery, std::move(work.count_faults));
  every(fleet::kTopEvery, std::move(work.look_at_top));
  every(kDronesEvery, std::move(work.look_at_drones));
  every(fleet::kHandshakeEvery, std::move(work.ask_relay));
  every(kConfigEvery, std::move(work.look_at_config));
  every(kAuditEvery, std::move(work.write_audit));
  every(kFeedEvery, std::move(work.feed_watchdog));
}

}  // namespace uplink::run
