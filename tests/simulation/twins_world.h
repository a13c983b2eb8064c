#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "tests/simulation/random.h"
#include "tests/simulation/recorder.h"
#include "tests/simulation/sim_broker.h"
#include "tests/simulation/twins_process.h"
#include "tests/support/fake_store.h"
#include "tests/support/manual_clock.h"

namespace uplink::simulation {

/// Whether the store becomes a standby that lacks the last commits.
enum class Failovers : std::uint8_t { kNo, kYes };

struct TwinsResult {
  /// Empty if every promise was kept; else the step and what was broken.
  std::string violation;
  std::uint64_t published = 0;
  std::uint64_t acked = 0;
  std::uint64_t redelivered = 0;
  std::uint64_t kills = 0;
  std::uint64_t failovers = 0;
};

/// Twins behind a broker, a server that reads them and is killed now and then, connections that
/// break, PUBACKs that are lost, and a store that fails and goes back: one seeded schedule, then a
/// time in which everything must settle.
///
/// A PUBACK means that the store has the message; each message is stored once; the messages'
/// conservation law holds after each step.
///
/// Thread: confined to its caller; nothing in it waits or reads a real clock.
class TwinsWorld final {
 public:
  TwinsWorld(std::uint64_t seed, Failovers failovers);
  TwinsResult Run();

 private:
  void Step();
  void Trouble();
  void Publish();
  /// False if the broker may deliver nothing.
  bool Deliver();
  void Start();
  void Kill();
  void GoBack();
  /// The journal has connected anew, and the reader must hear it.
  void OnReconnected();
  /// The reader knows of the oldest time that the journal connected anew.
  void OnTold();
  /// What was acked until now and the store lacks is gone.
  void NoteGone();
  void Pass(milliseconds time);
  void OnAcked(std::uint64_t number);
  void CheckLaw();
  void Settle();
  void CheckEnd();
  void Fail(const std::string& what);
  /// How often the store has each message.
  [[nodiscard]] std::multiset<std::uint64_t> Stored();

  const std::uint64_t seed_;
  const Failovers failovers_;
  Random random_;
  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  /// A standby that lacks the last commits, if there is one.
  testing::FakeDatabase copy_;
  bool has_copy_ = false;
  TwinsResult result_;
  std::uint64_t step_ = 0;
  Recorder recorder_;
  SimBroker broker_;
  std::uint8_t lives_ = 0;
  std::unique_ptr<testing::FakeStore> store_;
  std::unique_ptr<TwinsProcess> process_;
  /// Acked, and the broker has forgotten them; those that the store lost after that.
  std::set<std::uint64_t> acked_;
  std::set<std::uint64_t> gone_;
  /// Until the process has connected anew: what the store had before it went back.
  std::optional<std::multiset<std::uint64_t>> before_;
  /// The same of each time that the journal has connected anew and the reader was not told yet: the
  /// store may go back once more meanwhile.
  std::deque<std::multiset<std::uint64_t>> untold_;
  /// When the store is there again that went back last.
  std::uint64_t back_at_step_ = 0;
  /// Delivered since the store went back last, while nothing waited for a commit: none of them is
  /// acked for what the store had before.
  std::set<std::uint64_t> delivered_since_;
};

}  // namespace uplink::simulation
