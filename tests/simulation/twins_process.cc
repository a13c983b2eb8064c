#include "tests/simulation/twins_process.h"

#include <utility>

#include "schema/base/check.h"
#include "server/journal/turns.h"

namespace uplink::simulation {
namespace {

constexpr const char* kClientId = "core";
constexpr std::size_t kUnackedMax = 8;

mqtt::ClientSettings SettingsOf(const std::string& id, bool kept) {
  mqtt::ClientSettings settings;
  settings.url = {false, "broker", 1883};
  settings.version = mqtt::Version::k311;
  settings.client_id = id;
  settings.kept_session = kept;
  settings.unacked_max = kUnackedMax;
  return settings;
}

}  // namespace

TwinsProcess::TwinsProcess(const Ground& ground)
    : ground_(ground),
      leases_(ground_.database, ground_.id),
      logger_(std::make_unique<testing::NoLines>(), ground_.clock, log::Format::kText,
              log::Level::kError),
      journal_(ground_.recorder, {}, ground_.clock, ledger_, journal_probe_, ground_.id),
      fleet_(ground_.clock, 100, {}),
      broker_(ContextOf()) {
  broker_.SetLease(*this);
  journal_.OnReconnected([this](journal::Reconnected) {
    posted_.push_back([this] {
      ground_.in_doubt();
      broker_.Reread();
    });
  });
  const auto epoch = leases_.Take({.client_id = kClientId,
                                   .prefixes = {""},
                                   .over = ground_.over,
                                   .at = ground_.clock.System(),
                                   .unacked_max = kUnackedMax});
  UPLINK_CHECK(epoch.ok() && *epoch, "no other process has the topics");
  broker_.Begin({.hold = std::make_shared<const storage::TopicHold>(storage::TopicHold{
                     .client_id = kClientId, .epoch = **epoch, .unacked_max = kUnackedMax}),
                 .memory = *leases_.MemoryOf(kClientId),
                 .faults = {}});
}

broker::Broker::Context TwinsProcess::ContextOf() {
  return {
      .clock = ground_.clock,
      .logger = logger_,
      .fleet = fleet_,
      .journals = shards_,
      .ledger = messages_,
      .twins = twins_,
      .clients = {SettingsOf(kClientId, true), SettingsOf(std::string(kClientId) + "-live", false)},
      .terms = {},
      .fleet_name = "arms",
      .payload_bytes_max = 65'536,
      .journal_over_half = [] { return false; },
      .make_link = [this](mqtt::LinkEvents& events) { return ground_.broker.Connect(events); },
      .post = [this](std::function<void()> job) { posted_.push_back(std::move(job)); },
      .random = [this] { return ++drawn_ * 0x9E3779B97F4A7C15ULL + ground_.id[0]; },
      .allowances = allowances_};
}

void TwinsProcess::Write() { journal_.turns().Advance(); }

void TwinsProcess::TakePosted() {
  while (!posted_.empty()) {
    const auto job = std::move(posted_.front());
    posted_.pop_front();
    job();
  }
}

void TwinsProcess::ReadAgain() {
  const std::optional<std::uint64_t> asked = std::exchange(reread_, std::nullopt);
  if (!asked) return;
  auto memory = leases_.MemoryOf(kClientId);
  UPLINK_CHECK(memory.ok(), "the simulated store can be read");
  broker_.Resume({.asked = *asked, .memory = *std::move(memory), .faults = {}});
}

}  // namespace uplink::simulation
