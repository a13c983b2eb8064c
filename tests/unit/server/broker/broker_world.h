#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "server/broker/broker.h"
#include "server/journal/turns.h"
#include "tests/support/fake_leases.h"
#include "tests/support/fake_store.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"
#include "tests/support/mqtt_bytes.h"
#include "tests/unit/server/mqtt/fake_link.h"

namespace uplink::broker {

using metrics::Became;

/// Who has the lease, as a test says it.
class SaidLease final : public LeaseView {
 public:
  [[nodiscard]] bool MayConnect(SteadyTime /*since*/) const override { return may_connect; }
  void LookSoon() override { ++looks; }
  void RereadSoon(std::uint64_t asked) override {
    ++rereads;
    reread_asked = asked;
  }
  [[nodiscard]] bool failing() const override { return false; }
  [[nodiscard]] std::string held_by() const override { return {}; }

  bool may_connect = true;
  int looks = 0;
  int rereads = 0;
  std::uint64_t reread_asked = 0;
};

/// A broker's reader on the store in memory, its connections moved by hand.
class BrokerWorld : public ::testing::Test {
 protected:
  static constexpr const char* kTwin = "11111111-2222-4333-8444-555555555555";

  BrokerWorld() {
    broker_.SetLease(lease_);
    for (journal::Journal* journal : shards_.all()) {
      journal->OnReconnected(
          [this](journal::Reconnected) { posted_.emplace_back([this] { broker_.Reread(); }); });
    }
  }

  static mqtt::ClientSettings Settings(const std::string& id, bool kept) {
    mqtt::ClientSettings settings;
    settings.url = {false, "broker", 1883};
    settings.version = mqtt::Version::k311;
    settings.client_id = id;
    settings.kept_session = kept;
    settings.unacked_max = 8;
    return settings;
  }
  void Begin() {
    const auto epoch = leases_.Take(
        {.client_id = "core", .prefixes = {""}, .at = clock_.System(), .unacked_max = 8});
    broker_.Begin({.hold = std::make_shared<const storage::TopicHold>(
                       storage::TopicHold{.client_id = "core", .epoch = **epoch, .unacked_max = 8}),
                   .memory = *leases_.MemoryOf("core"),
                   .faults = {}});
  }
  /// The connection comes up and is subscribed.
  void Up(const std::shared_ptr<testing::FakeLink>& link, bool session_present = false) {
    link->events()->OnPhase(mqtt::LinkPhase::kConnecting);
    link->events()->OnUp();
    Flush(*link);
    link->Bring(
        testing::MqttPacket(0x20, session_present ? testing::Raw("\1\0") : testing::Raw("\0\0")));
    // Each SUBSCRIBE is answered as it was asked.
    for (std::size_t id = 1; id <= 8 && link->writing; ++id) {
      const std::string asked = link->written;
      Flush(*link);
      if (!link->reading) break;
      Answer(*link, asked);
    }
    Flush(*link);
    link->written.clear();
  }
  static void Flush(testing::FakeLink& link) {
    while (!link.closed && link.writing) link.FinishWrite();
  }
  /// SUBACKs for the SUBSCRIBEs that were written.
  static void Answer(testing::FakeLink& link, std::string_view written) {
    std::string answers;
    while (!written.empty()) {
      std::size_t length = 0;
      std::size_t at = 1;
      for (unsigned shift = 0;; shift += 7) {
        const auto digit = static_cast<unsigned char>(written[at++]);
        length |= static_cast<std::size_t>(digit & 0x7FU) << shift;
        if (digit < 0x80U) break;
      }
      const std::string_view body = written.substr(at, length);
      if ((static_cast<unsigned char>(written[0]) >> 4U) == 8) {
        std::string codes(body.substr(0, 2));
        for (std::size_t next = 2; next < body.size();) {
          const auto topic =
              (static_cast<std::size_t>(static_cast<unsigned char>(body[next])) << 8U) |
              static_cast<unsigned char>(body[next + 1]);
          next += 2 + topic;
          codes.push_back(body[next++]);
        }
        answers += testing::MqttPacket(0x90, codes);
      }
      written.remove_prefix(at + length);
    }
    link.written.clear();
    if (!answers.empty()) link.Bring(answers);
  }
  void Posted() {
    while (!posted_.empty()) {
      auto job = std::move(posted_.front());
      posted_.pop_front();
      job();
    }
  }
  void Run() {
    for (journal::Journal* journal : shards_.all()) Write(*journal);
    Posted();
  }
  static void Write(journal::Journal& journal) {
    while (journal.turns().Advance() == journal::Step::kWorked) {
    }
  }
  [[nodiscard]] journal::Journal& JournalOf(const std::string& twin) {
    return shards_.Of("rcan://local.rcan/cyberwave/twin/" + twin);
  }
  /// One whose robot is in another shard than that of kTwin.
  [[nodiscard]] std::string TwinOfAnotherShard() {
    std::string twin = kTwin;
    while (&JournalOf(twin) == &JournalOf(kTwin) && twin[0] < '9') ++twin[0];
    EXPECT_NE(&JournalOf(twin), &JournalOf(kTwin));
    return twin;
  }
  static std::string Event(int number, std::size_t id, bool dup = false) {
    return EventOf(kTwin, number, id, dup);
  }
  static std::string EventOf(const std::string& twin, int number, std::size_t id,
                             bool dup = false) {
    return testing::PublishBytes{
        .topic = "cyberwave/twin/" + twin + "/event",
        .payload = R"({"event_type":"x","n":)" + std::to_string(number) + "}",
        .id = id,
        .dup = dup,
        .mqtt5 = false}
        .Text();
  }
  static std::string Puback(std::size_t id) {
    return testing::MqttPacket(0x40, testing::MqttU16(id));
  }
  [[nodiscard]] std::size_t Stored() { return store_.Events({})->rows.size(); }
  [[nodiscard]] const std::shared_ptr<testing::FakeLink>& durable() const { return links_.at(0); }
  [[nodiscard]] const std::shared_ptr<testing::FakeLink>& live() const { return links_.at(1); }
  void Connect() {
    Begin();
    Up(durable());
    Up(live());
    broker_.Tick();
    Run();
  }
  [[nodiscard]] std::uint64_t Count(Became became) const {
    return broker_.ledger().Read().messages.*
           metrics::kBecame.at(static_cast<std::size_t>(became)).count;
  }

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  testing::FakeStore store_{database_, {1}};
  testing::FakeTopicLeases leases_{database_, {1}};
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  metrics::Ledger ledger_;
  metrics::Ledger messages_;
  journal::JournalProbe journal_probe_;
  journal::JournalLimits limits_{.records_max = 3};
  journal::Journal journal_{store_, limits_, clock_, ledger_, journal_probe_, {1}};
  journal::Journal other_journal_{store_, limits_, clock_, ledger_, journal_probe_, {1}};
  journal::Shards shards_{{&journal_, &other_journal_}};
  fleet::Fleet fleet_{clock_, 100, {}};
  cyberwave::Twins twins_{100};
  SaidLease lease_;
  std::deque<std::function<void()>> posted_;
  /// In the order in which they were made.
  std::vector<std::shared_ptr<testing::FakeLink>> links_;
  std::uint64_t drawn_ = 0;
  const ingest::Allowances allowances_;
  Broker broker_{{.clock = clock_,
                  .logger = logger_,
                  .fleet = fleet_,
                  .journals = shards_,
                  .ledger = messages_,
                  .twins = twins_,
                  .clients = {Settings("core", true), Settings("core-live", false)},
                  .terms = {},
                  .fleet_name = "arms",
                  .payload_bytes_max = 65'536,
                  .journal_over_half = [] { return false; },
                  .make_link =
                      [this](mqtt::LinkEvents& events) {
                        links_.push_back(std::make_shared<testing::FakeLink>(events));
                        return links_.back();
                      },
                  .post = [this](std::function<void()> job) { posted_.push_back(std::move(job)); },
                  .random = [this] { return ++drawn_; },
                  .allowances = allowances_}};
};

}  // namespace uplink::broker
