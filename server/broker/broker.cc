#include "server/broker/broker.h"

#include <utility>

#include "schema/base/check.h"
#include "server/broker/client_certificate.h"
#include "server/broker/filters.h"
#include "server/broker/limits.h"

namespace uplink::broker {
Broker::Broker(Context context)
    : context_(std::move(context)),
      connection_log_(context_.logger, context_.clock, context_.clients.front().url.Text()),
      refused_log_(context_.logger),
      limited_log_(context_.logger),
      health_(context_.clock, probe_),
      statuses_(context_.clients),
      wakes_([this] { context_.post([this] { OnWakes(); }); }),
      subscribers_{Subscriber(Connection::kDurable, *this), Subscriber(Connection::kLive, *this),
                   Subscriber(Connection::kMedia, *this)},
      streams_({.clock = context_.clock,
                .fleet = context_.fleet,
                .journals = context_.journals,
                .twins = context_.twins,
                .inbox = wakes_,
                .fleet_name = context_.fleet_name,
                .random = context_.random,
                .reports = context_.reports}),
      commits_({.streams = streams_,
                .ledger = context_.ledger,
                .probe = probe_,
                .clock = context_.clock,
                .journals = context_.journals,
                .committed =
                    [this](std::size_t shard) {
                      context_.post([this, shard] { OnCommitted(shard); });
                    }}),
      intake_({.clock = context_.clock,
               .fleet = context_.fleet,
               .twins = context_.twins,
               .streams = streams_,
               .commits = commits_,
               .ledger = context_.ledger,
               .probe = probe_,
               .refused_log = refused_log_,
               .limited_log = limited_log_,
               .terms = context_.terms,
               .payload_bytes_max = context_.payload_bytes_max,
               .journal_over_half = context_.journal_over_half,
               .publish =
                   [this](const mqtt::Outgoing& message) {
                     mqtt::Client* client = Of(Connection::kLive).client();
                     return client != nullptr && client->Publish(message);
                   },
               .allowances = context_.allowances}),
      strays_(context_.terms.prefixes) {
  NoteCertificate(context_.clients.front(), probe_);
}

void Broker::Begin(Grant grant) {
  if (draining_) return;
  if (began_) End();
  began_ = true;
  const bool session_expected = grant.memory.last_number > 0;
  probe_.lease_held.Set(1);
  probe_.lease_taken.Add();
  commits_.Begin(std::move(grant.hold), grant.memory);
  streams_.SetFaults(std::move(grant.faults));
  // The reader of a twin's topics holds the twin's robots.
  streams_.OpenKnown(context_.terms.prefixes, TwinStreams::Which::kAll);
  fleet_changes_ = context_.fleet.changes();
  for (std::size_t i = 0; i < context_.clients.size(); ++i) {
    Start(static_cast<Connection>(i), session_expected);
  }
}

void Broker::Start(Connection connection, bool expect_session) {
  Subscriber& subscriber = Of(connection);
  mqtt::ClientSettings settings = context_.clients[static_cast<std::size_t>(connection)];
  settings.expect_session = settings.kept_session && expect_session;
  auto client = mqtt::Client::Create(
      std::move(settings),
      {.listener = subscriber,
       .probe = subscriber.probe(),
       .clock = context_.clock,
       .random = context_.random,
       .make_link = context_.make_link,
       .numbers = numbers_,
       .may_connect = [this] { return lease_ == nullptr || lease_->MayConnect(ask_since_); }});
  UPLINK_CHECK(client.ok(), "the configuration's settings were checked");
  const absl::Status wanted = (*client)->SetFilters(FiltersOf(connection, context_.terms.prefixes));
  UPLINK_CHECK(wanted.ok(), "the configuration's prefixes make good filters");
  subscriber.SetClient(*std::move(client));
  subscriber.client()->Start();
}

void Broker::UnsubscribeStray(std::string_view topic) {
  if (!strays_.Add(topic)) return;
  context_.logger.Info("mqtt_prefix_gone", {{"prefix", strays_.prefixes().back()}});
  // They are valid filters, as configured prefixes are.
  static_cast<void>(Of(Connection::kDurable)
                        .client()
                        ->SetFilters(FiltersOf(Connection::kDurable, context_.terms.prefixes),
                                     strays_.Filters()));
}

void Broker::StopClient(Connection connection) {
  Subscriber& subscriber = Of(connection);
  if (subscriber.client() == nullptr) return;
  subscriber.client()->Stop();
  subscriber.NoteStopped();
  subscriber.SetClient(nullptr);
  if (connection == Connection::kDurable) DropHeldBack();
  UpdateHealth();
}

void Broker::DropHeldBack() {
  if (!held_) return;
  held_.reset();
  intake_.DropHeldBack();
}

void Broker::End() {
  if (!std::exchange(began_, false)) return;
  StoreExpired();
  probe_.lease_held.Set(0);
  rereading_.End();
  for (std::size_t i = 0; i < context_.clients.size(); ++i) StopClient(static_cast<Connection>(i));
  streams_.EndAll(draining_ ? transport::EndCause::kDrain : transport::EndCause::kSuperseded);
  context_.twins.Clear();
}

void Broker::Reread() {
  commits_.BeginReread();
  streams_.BeginReread();
  if (!began_ || draining_) return;
  if (!rereading_.active()) context_.post([this] { StopClient(Connection::kDurable); });
  const std::uint64_t request = rereading_.Ask();
  if (lease_ != nullptr) lease_->RereadSoon(request);
}

void Broker::Resume(Remembered remembered) {
  if (!rereading_.EndOnAnswer(remembered.asked) || !began_ || draining_) return;
  StopClient(Connection::kDurable);
  commits_.Reread(remembered.memory);
  streams_.SetFaults(std::move(remembered.faults));
  Start(Connection::kDurable, true);
}

void Broker::BeginDrain() {
  draining_ = true;
  for (Subscriber& subscriber : subscribers_) {
    if (subscriber.client() != nullptr) subscriber.client()->StopReading();
  }
  // It was not acked, and comes again.
  DropHeldBack();
  AfterWork();
  StoreExpired();
}

void Broker::OnConnected(Connection connection, const mqtt::Connected& connected) {
  connection_log_.Connected(connection, connected);
  NoteStatuses();
  if (connection != Connection::kDurable) return;
  commits_.BeginConnection();
  strays_.Clear();
  if (connected.session_present) return;
  // Also if no session was expected: the deliveries of an older session never come again.
  context_.journals.all().front()->Remember(commits_.EndSession());
}

void Broker::OnSubscribed(Connection connection) {
  connection_log_.Subscribed(connection);
  UpdateHealth();
  // We missed what twins said until now, however briefly.
  if (connection != Connection::kMedia) context_.fleet.NoteTwinsUnheard();
}

void Broker::OnMessage(Connection connection, const mqtt::Message& message) {
  const cyberwave::Arrival arrived{context_.clock.Steady(), context_.clock.System()};
  if (connection != Connection::kDurable) return OnLive(connection, message, arrived);
  // The robot's faults are unknown until the store was read.
  if (rereading_.active()) return intake_.Refuse();
  const Intake::Processed taken = intake_.Process(message, arrived);
  if (intake_.was_stray()) UnsubscribeStray(message.publish.topic);
  if (taken == Intake::Processed::kHeldBack) {
    held_.emplace(message, arrived);
    Of(connection).client()->StopReading();
    intake_.WakeWhenRoom({.inbox = &wakes_, .stream = kRoom});
  }
  AfterWork();
}

void Broker::OnLive(Connection connection, const mqtt::Message& message,
                    const cyberwave::Arrival& arrived) {
  // We subscribed at QoS 0. If a broker sends it at QoS 1, it gets its ack at once.
  mqtt::Message live = message;
  live.publish.id = 0;
  live.again = false;
  if (const auto ack = std::exchange(live.ack, std::nullopt)) {
    Of(connection).client()->Release(*ack);
  }
  static_cast<void>(intake_.Process(live, arrived));
  AfterWork();
}

void Broker::OnTrouble(Connection connection, const mqtt::Trouble& trouble) {
  connection_log_.Trouble(connection, trouble);
}

void Broker::OnEnded(Connection connection, const mqtt::End& end) {
  connection_log_.Ended(connection, end);
  ask_since_ = context_.clock.Steady();
  if (lease_ != nullptr) lease_->LookSoon();
  UpdateHealth();
  if (connection != Connection::kDurable || !held_) return;
  DropHeldBack();
  Of(connection).client()->ReadAgain();
}

void Broker::OnWakes() {
  for (const std::uint64_t stream : wakes_.Take()) {
    if (stream != kRoom) commits_.OnWake(stream);
  }
  TryHeldBack();
  AfterWork();
}

void Broker::TryHeldBack() {
  if (!held_ || draining_) return;
  if (intake_.ProcessHeldBack(*held_) == Intake::Processed::kHeldBack) {
    return intake_.WakeWhenRoom({.inbox = &wakes_, .stream = kRoom});
  }
  held_.reset();
  if (mqtt::Client* client = Of(Connection::kDurable).client()) client->ReadAgain();
}

void Broker::AfterWork() {
  mqtt::Client* client = Of(Connection::kDurable).client();
  if (client != nullptr && !rereading_.active()) {
    if (const auto due = commits_.TakeReleases(); !due.empty()) client->Release(due);
  }
  if (draining_ && waiting() == 0) {
    const std::lock_guard lock(mutex_);
    settled_.notify_all();
  }
  // The robot's waiting messages were not written, or were written without an answer. The broker
  // must deliver them again, once the store has said what it has.
  if (!commits_.TakeFenced() || !began_ || draining_) return;
  context_.logger.Warn("mqtt_twins_lost", {});
  Reread();
}

void Broker::StoreExpired() {
  storage::Deliveries expired = commits_.TakeExpired();
  if (expired.rows.empty()) return;
  context_.journals.all().front()->Remember(std::move(expired));
}

void Broker::Tick() {
  const SteadyTime now = context_.clock.Steady();
  TryHeldBack();
  AfterWork();
  StoreExpired();
  UpdateHealth();
  if (!health_.subscribed_since()) streams_.NoteUnheard(now);
  // It starts clean, so the broker drops what it has queued.
  if (health_.live_is_old()) Of(Connection::kLive).client()->ConnectAnew(BehindEnd());
  probe_.streams.Set(static_cast<std::int64_t>(streams_.size()));
  if (began_ && context_.fleet.changes() != fleet_changes_) {
    fleet_changes_ = context_.fleet.changes();
    // Robots that the store had, and that were read late.
    streams_.OpenKnown(context_.terms.prefixes, TwinStreams::Which::kNotHeld);
  }
  if (!twin_looks_.Take(now, kLookAtTwinsEvery)) return;
  NoteCertificate(context_.clients.front(), probe_);
  streams_.CloseIdle();
  streams_.ForgetLeft();
}

void Broker::UpdateHealth() {
  mqtt::Client* live = Of(Connection::kLive).client();
  health_.Update(
      {.subscribed =
           began_ && Of(Connection::kDurable).subscribed() && Of(Connection::kLive).subscribed(),
       .unacked_max = unacked_max(),
       .live_unread = live == nullptr ? 0 : live->unread(),
       .live_ping_waited = live == nullptr ? SteadyTime::duration::zero() : live->ping_waited()},
      client_probe(Connection::kDurable));
  NoteStatuses();
}

void Broker::NoteStatuses() {
  for (std::size_t i = 0; i < context_.clients.size(); ++i) {
    statuses_.Note(static_cast<Connection>(i), subscribers_[i].client());
  }
}

}  // namespace uplink::broker
