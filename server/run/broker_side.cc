#include "server/run/broker_side.h"

#include <future>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "server/broker/broker.h"
#include "server/broker/samples.h"
#include "server/config/broker_url.h"
#include "server/loop/event_loop.h"
#include "server/mqtt/asio_link.h"
#include "server/run/from_config.h"
#include "server/store/topic_rounds.h"

namespace uplink::run {
namespace {

constexpr std::chrono::seconds kTickEvery{1};
/// How long /readyz shows that the broker lost a session.
constexpr std::chrono::hours kSessionLostShown{1};
/// For what waits for its commit at the end.
constexpr std::chrono::seconds kLastCommits{2};
/// For DISCONNECT to leave.
constexpr std::chrono::seconds kFarewell{1};

std::vector<mqtt::ClientSettings> ClientsOf(const config::Config& config) {
  using enum cyberwave::Connection;
  std::vector<mqtt::ClientSettings> clients{ClientSettingsOf(config, kDurable),
                                            ClientSettingsOf(config, kLive)};
  if (config.cyberwave.media == config::CyberwaveMedia::kCount) {
    clients.push_back(ClientSettingsOf(config, kMedia));
  }
  return clients;
}

bool OverHalf(const journal::Shards& journals, const journal::JournalLimits& limits) {
  return 2 * journals.bytes() > limits.bytes_max || 2 * journals.records() > limits.records_max;
}

view::BrokerConnection ViewOf(const broker::ConnectionStatus& status) {
  const mqtt::ClientStatus& client = status.client;
  return {.name = std::string(broker::Name(status.connection)),
          .client_id = status.client_id,
          .state = std::string(mqtt::Name(client.state)),
          .connected_since = client.connected_since,
          .session_present = client.session_present,
          .unacked = client.unacked,
          .filters_refused = client.filters_refused,
          .filters_lower = client.filters_lower,
          .last_error = client.last_error,
          .last_error_at = client.last_error_at};
}

}  // namespace

/// What there is only with a broker.
struct BrokerSide::Parts {
  Parts(const Context& context, cyberwave::Twins& twins,
        std::unique_ptr<storage::TopicLeases> leases)
      : loop(context.logger),
        broker(BrokerContext(context, twins)),
        topics(std::move(leases), TopicsContext(context)) {
    broker.SetLease(topics);
    loop.Every(kTickEvery, [this] { broker.Tick(); });
  }

  broker::Broker::Context BrokerContext(const Context& context, cyberwave::Twins& twins) {
    return {
        .clock = context.clock,
        .logger = context.logger,
        .fleet = context.fleet,
        .journals = context.journals,
        .ledger = context.ledgers.NewPage(model::MessageSource::kCyberwave),
        .twins = twins,
        .clients = ClientsOf(context.config),
        .terms = JudgeTermsOf(context.config.cyberwave),
        .fleet_name = context.config.cyberwave.fleet,
        .payload_bytes_max = context.config.limits.payload_bytes_max,
        .journal_over_half = [&journals = context.journals,
                              limits =
                                  context.journal_limits] { return OverHalf(journals, limits); },
        .make_link =
            [this](mqtt::LinkEvents& events) { return mqtt::MakeAsioLink(loop.io(), events); },
        .post = [this](std::function<void()> job) { loop.Post(std::move(job)); },
        // The writers draw from the other one on their threads.
        .random = [own = std::make_shared<std::mt19937_64>(context.random())] { return (*own)(); },
        .allowances = context.allowances,
        .reports = &context.reports};
  }

  store::TopicRounds::Context TopicsContext(const Context& context) {
    return {
        .clock = context.clock,
        .logger = context.logger,
        .reader = context.reader,
        .process = context.process,
        .client_id = context.config.mqtt.client_id,
        .prefixes = context.config.cyberwave.topic_prefixes,
        .judge = [&leases = context.leases](
                     const storage::ProcessId& process) { return leases.VerdictOf(process); },
        .taken =
            [this](broker::Grant grant) {
              loop.Post([this, grant = std::move(grant)] { broker.Begin(grant); });
            },
        .lost = [this] { loop.Post([this] { broker.End(); }); },
        .reread =
            [this](broker::Remembered remembered) {
              loop.Post([this, remembered = std::move(remembered)] { broker.Resume(remembered); });
            },
        .reconnected = [this] { loop.Post([this] { broker.Reread(); }); }};
  }

  loop::EventLoop loop;
  broker::Broker broker;
  store::TopicRounds topics;
};

BrokerSide::BrokerSide(const Context& context, std::unique_ptr<storage::TopicLeases> topics)
    : context_(context), twins_(context.config.cyberwave.robots_max, context.fleet.live_total()) {
  if (topics != nullptr) parts_ = std::make_unique<Parts>(context_, twins_, std::move(topics));
}

BrokerSide::~BrokerSide() { Stop(); }

void BrokerSide::Start() {
  if (parts_ == nullptr) return;
  parts_->loop.Start();
  parts_->topics.Start();
}

void BrokerSide::BeginDrain() {
  if (parts_ == nullptr) return;
  parts_->loop.Post([this] { parts_->broker.BeginDrain(); });
}

void BrokerSide::EndDrain() {
  if (parts_ == nullptr) return;
  parts_->broker.WaitSettled(context_.clock.Steady() + kLastCommits);
  // Before it is another's: who connects with our id ends us.
  const auto told = std::make_shared<std::promise<void>>();
  parts_->loop.Post([this, told] {
    parts_->broker.End();
    told->set_value();
  });
  told->get_future().wait_for(kFarewell);
  parts_->topics.Leave();
}

void BrokerSide::Reread() {
  if (parts_ == nullptr) return;
  parts_->loop.Post([this] { parts_->broker.Reread(); });
}

void BrokerSide::Stop() {
  if (parts_ == nullptr) return;
  parts_->topics.Stop();
  parts_->loop.Stop();
}

fleet::Fleet::HearingState BrokerSide::hearing() const {
  return parts_ == nullptr ? fleet::Fleet::HearingState::kBehind : parts_->broker.hearing();
}

std::optional<view::BrokerStatus> BrokerSide::status() const {
  if (parts_ == nullptr) return std::nullopt;
  const auto url = config::ParseBrokerUrl(context_.config.mqtt.url);
  view::BrokerStatus status{.url = url.ok() ? url->Text() : std::string(),
                            .holds_lease = parts_->broker.holds_lease(),
                            .held_by = parts_->topics.held_by(),
                            .prefixes = context_.config.cyberwave.topic_prefixes,
                            .twins = twins_.size(),
                            .subscribed_since = parts_->broker.subscribed_since()};
  for (const broker::ConnectionStatus& each : parts_->broker.connections()) {
    status.connections.push_back(ViewOf(each));
  }
  return status;
}

health::BrokerFacts BrokerSide::facts() const {
  if (parts_ == nullptr) return {};
  const broker::Broker& broker = parts_->broker;
  health::BrokerFacts facts{.away = broker.holds_lease() ? !broker.subscribed_since().has_value()
                                                         : parts_->topics.held_by().empty(),
                            .unread = broker.probe().behind.value() != 0,
                            .twins = {twins_.size(), twins_.twins_max()}};
  const auto lost_at = broker.session_lost_at();
  facts.session_lost = lost_at && context_.clock.System() - *lost_at < kSessionLostShown;
  for (const broker::ConnectionStatus& each : broker.connections()) {
    const mqtt::ClientStatus& client = each.client;
    facts.filters = facts.filters || client.filters_refused > 0 || client.filters_lower > 0;
    facts.id_taken = facts.id_taken || client.state == mqtt::ClientState::kIdTaken;
  }
  return facts;
}

void BrokerSide::AddSamples(metrics::Exposition& page) const {
  if (parts_ == nullptr) return;
  broker::AddSamples(parts_->broker, page);
}

}  // namespace uplink::run
