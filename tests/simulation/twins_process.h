#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/broker/broker.h"
#include "server/journal/journal.h"
#include "server/journal/shards.h"
#include "tests/simulation/recorder.h"
#include "tests/simulation/sim_broker.h"
#include "tests/support/fake_leases.h"
#include "tests/support/kept_lines.h"

namespace uplink::simulation {

/// One life of a server that reads twins from a broker: the real reader, clients, journal and fleet
/// on links that are moved by hand.
///
/// Thread: confined to its caller.
class TwinsProcess final : public broker::LeaseView {
 public:
  /// The references outlive it.
  struct Ground {
    const Clock& clock;
    testing::FakeDatabase& database;
    Recorder& recorder;
    SimBroker& broker;
    storage::ProcessId id{};
    /// Who had the topics before.
    std::vector<storage::OverHolder> over;
    /// The reader knows that the store may lack what was acked.
    std::function<void()> in_doubt;
  };
  explicit TwinsProcess(const Ground& ground);

  // --- Steps of its threads ---

  /// The journal's writer.
  void Write();
  /// What other threads left for the broker's.
  void TakePosted();
  /// The thread that asks the store about topics.
  void ReadAgain();
  /// Each second.
  void Tick() { broker_.Tick(); }

  [[nodiscard]] metrics::MessageCounts counts() const { return broker_.ledger().Read().messages; }
  [[nodiscard]] bool idle() const { return journal_.idle() && posted_.empty() && !reread_; }

  // broker::LeaseView
  [[nodiscard]] bool MayConnect(SteadyTime /*since*/) const override { return true; }
  void LookSoon() override {}
  void RereadSoon(std::uint64_t asked) override { reread_ = asked; }
  [[nodiscard]] bool failing() const override { return false; }
  [[nodiscard]] std::string held_by() const override { return {}; }

 private:
  [[nodiscard]] broker::Broker::Context ContextOf();

  const Ground ground_;
  testing::FakeTopicLeases leases_;
  log::Logger logger_;
  metrics::Ledger ledger_;
  metrics::Ledger messages_;
  const ingest::Allowances allowances_;
  journal::JournalProbe journal_probe_;
  journal::Journal journal_;
  journal::Shards shards_{{&journal_}};
  fleet::Fleet fleet_;
  cyberwave::Twins twins_{100};
  std::deque<std::function<void()>> posted_;
  std::uint64_t drawn_ = 0;
  /// What was asked for and is not told yet.
  std::optional<std::uint64_t> reread_;
  broker::Broker broker_;
};

}  // namespace uplink::simulation
