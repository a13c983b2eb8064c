#pragma once

#include <condition_variable>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "metrics/ledger.h"
#include "server/fleet/fleet.h"
#include "server/health/monitor.h"
#include "server/http/probe.h"
#include "server/http/scrape.h"
#include "server/http/site.h"
#include "server/journal/journal.h"
#include "server/session/probe.h"
#include "server/view/queries.h"
#include "tests/support/fake_store.h"
#include "tests/support/manual_clock.h"

namespace uplink::testing {

/// A reader that can be away, and can hold its callers. Thread-safe.
class SwitchedReader final : public storage::Reader {
 public:
  explicit SwitchedReader(storage::Reader& reader) : reader_(reader) {}

  void SetAway(bool away);
  /// Calls wait until Release.
  void Hold();
  void Release();
  /// True once a held call waits; false after `deadline`.
  [[nodiscard]] bool WaitUntilHeld(milliseconds deadline);
  [[nodiscard]] int calls() const;

  absl::StatusOr<std::vector<storage::RobotRow>> Robots(std::uint32_t robots_max) override;
  absl::StatusOr<storage::Page<storage::FaultRow>> FaultsActive(
      const storage::HistoryQuery& query) override;
  absl::StatusOr<storage::Page<storage::FaultRow>> FaultHistory(
      const storage::HistoryQuery& query) override;
  absl::StatusOr<std::vector<storage::ActiveFaults>> ActiveFaultCounts(
      std::span<const std::string> ruris) override;
  absl::StatusOr<storage::Page<storage::QuarantineRow>> Quarantine(
      const storage::HistoryQuery& query) override;
  absl::StatusOr<storage::Page<storage::GapRow>> Gaps(const storage::HistoryQuery& query) override;

 private:
  [[nodiscard]] absl::Status Enter();

  storage::Reader& reader_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool away_ = false;
  bool held_ = false;
  int calls_ = 0;
  int inside_ = 0;
};

/// What stands behind the HTTP site, on a fake store and a clock moved by hand.
class ServerWorld {
 public:
  static constexpr std::size_t kRobotsMax = 5;

  ServerWorld();

  /// Admits a robot and writes its row.
  fleet::Robot& AddRobot(const std::string& ruri, const std::string& fleet = "default");
  /// Commits these for the robot, numbered on from the last.
  void Commit(const std::string& ruri, std::vector<storage::CommitRecord> records,
              std::vector<storage::GapItem> gaps = {});
  void CommitFault(const std::string& ruri, const model::Fault& fault);
  void CommitQuarantine(const std::string& ruri, const model::Rejection& rejection,
                        const std::string& payload);
  void CommitGap(const std::string& ruri, model::Seq first, model::Seq last);

  [[nodiscard]] http::Response Get(const std::string& target) const;

  ManualClock clock;
  FakeDatabase database;
  FakeStore store{database, storage::ProcessId{1}};
  SwitchedReader reader{store};
  metrics::LedgerBook ledgers;
  journal::JournalLimits journal_limits;
  journal::JournalProbe journal_probe;
  session::SessionProbe sessions;
  http::HttpProbe http_probe;
  fleet::Fleet fleet{clock, kRobotsMax, fleet::PresenceLimits{}};
  journal::Journal journal;
  view::Queries queries;
  health::Monitor monitor;
  http::Scrape scrape;
  http::Site site;

  static model::SessionId session();

 private:
  storage::CommitRecord Next(const std::string& ruri);

  model::Seq last_seq_ = 0;
};

}  // namespace uplink::testing
