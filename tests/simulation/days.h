#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "storage/sqlite/store.h"
#include "tests/simulation/recorder.h"
#include "tests/simulation/sim_server.h"
#include "tests/support/manual_clock.h"
#include "tests/support/temp_folder.h"

namespace uplink::simulation {

struct DaysOptions {
  int days = 30;
  int robots = 20;
  /// store.retention.* of the run.
  int history_days = 7;
  int quarantine_days = 2;
};

/// What there is at the end of one day. A value.
struct DayFigures {
  int day = 0;
  /// Rows by table.
  std::map<std::string, std::int64_t> rows;
  std::int64_t file_kib = 0;
};

/// Days of a fleet on the real core and the real SQLite store, with a clock that is moved by hand:
/// a robot works two of every three hours, tells a little of everything, breaks off and is missed.
/// Presence, expiry and retention do their work as they would.
///
/// Thread: confined to one thread.
class Days final {
 public:
  explicit Days(const DaysOptions& options);

  /// All of them; figures of each.
  [[nodiscard]] std::vector<DayFigures> Run();

 private:
  void Hour(int hour);
  void Visit(int robot, int hour);
  void Settle();
  void Pass(milliseconds time);
  [[nodiscard]] DayFigures Figures(int day);

  const DaysOptions options_;
  testing::TempFolder folder_;
  testing::ManualClock clock_;
  std::unique_ptr<storage::sqlite::SqliteStore> store_;
  Recorder recorder_;
  std::unique_ptr<SimServer> server_;
  std::map<int, model::Seq> last_seq_;
};

}  // namespace uplink::simulation
