#include "server/mqtt/client.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "schema/base/utf8.h"
#include "server/mqtt/encode.h"
#include "server/mqtt/limits.h"
#include "server/mqtt/reason_codes.h"
#include "server/mqtt/secrets.h"

namespace uplink::mqtt {
namespace {

milliseconds WaitOf(LinkPhase phase, const Waits& waits) {
  switch (phase) {
    case LinkPhase::kResolving:
      return waits.resolve;
    case LinkPhase::kConnecting:
      return waits.connect;
    case LinkPhase::kHandshaking:
      return waits.tls;
  }
  return waits.connect;
}

const char* LateText(LinkPhase phase) {
  switch (phase) {
    case LinkPhase::kResolving:
      return "the broker's name was not resolved in time";
    case LinkPhase::kConnecting:
      return "the broker did not take the connection in time";
    case LinkPhase::kHandshaking:
      return "the TLS handshake did not end in time";
  }
  return "";
}

}  // namespace

absl::StatusOr<std::unique_ptr<Client>> Client::Create(ClientSettings settings, Parts parts) {
  if (absl::Status good = CheckSettings(settings); !good.ok()) return good;
  return std::unique_ptr<Client>(new Client(std::move(settings), std::move(parts)));
}

Client::Client(ClientSettings settings, Parts parts)
    : settings_(std::move(settings)),
      parts_(std::move(parts)),
      reconnect_(settings_.reconnect),
      had_session_(settings_.expect_session) {}

Client::~Client() {
  settling_ = false;
  Stop();
}

void Client::Start() {
  if (phase_ != Phase::kStopped || settling_) return;
  link_ = parts_.make_link(*this);
  Attempt();
}

void Client::Stop() {
  if (phase_ == Phase::kStopped && link_ == nullptr) return;
  phase_ = Phase::kStopped;
  if (settling_) return conversation_->Leave();  // Settle ends it
  const bool accepted = conversation_ != nullptr && conversation_->accepted_at().has_value();
  if (link_ != nullptr) parts_.probe.CountEnd(EndReason::kStopped);
  CloseConnection(accepted ? conversation_->TakeRest() + EncodeDisconnect(settings_.version, 0)
                           : "");
  parts_.probe.id_taken.Set(0);
  parts_.probe.stopped_by_core.Set(0);
  Show(ClientState::kStopped);
}

absl::Status Client::SetFilters(const std::vector<Filter>& filters,
                                const std::vector<std::string>& gone) {
  std::vector<Filter> gone_filters;
  gone_filters.reserve(gone.size());
  for (const std::string& topic : gone) gone_filters.push_back({.topic = topic});
  if (absl::Status good = CheckFilters(filters); !good.ok()) return good;
  if (absl::Status good = CheckFilters(gone_filters); !good.ok()) return good;
  subscriptions_.Want(filters, gone);
  if (conversation_ == nullptr) return absl::OkStatus();
  conversation_->Ask();
  if (conversation_->accepted_at() && !conversation_->subscribed()) Show(ClientState::kSubscribing);
  Settle();
  return absl::OkStatus();
}

void Client::Release(std::span<const AckHandle> handles) {
  if (conversation_ == nullptr) {
    return parts_.probe.releases_late.Add(static_cast<std::int64_t>(handles.size()));
  }
  for (const AckHandle& each : handles) conversation_->Release(each);
  Settle();
}

bool Client::Publish(const Outgoing& message) {
  if (conversation_ == nullptr) {
    parts_.probe.publishes_dropped.Add();
    return false;
  }
  const bool sent = conversation_->Publish(message);
  Settle();
  return sent;
}

void Client::StopReading() {
  stopped_reading_ = true;
  parts_.probe.stopped_by_core.Set(1);
  if (conversation_ != nullptr) conversation_->StopReading();
}

void Client::ReadAgain() {
  stopped_reading_ = false;
  parts_.probe.stopped_by_core.Set(0);
  if (conversation_ == nullptr) return;
  conversation_->ReadAgain();
  Settle();
}

ClientStatus Client::status() const {
  ClientStatus status = status_.Read();
  status.unacked =
      static_cast<std::size_t>(std::max<std::int64_t>(parts_.probe.unacked.value(), 0));
  status.filters_refused = static_cast<std::size_t>(parts_.probe.filters_refused.value());
  status.filters_lower = static_cast<std::size_t>(parts_.probe.filters_lower.value());
  return status;
}

void Client::Attempt() {
  if (parts_.may_connect && !parts_.may_connect()) {
    phase_ = Phase::kPausing;
    due_ = parts_.clock.Steady() + kGatePause;
    Show(ClientState::kWaiting);
    return Arm();
  }
  phase_ = Phase::kOpening;
  connection_ = parts_.numbers.Next();
  Show(ClientState::kConnecting);
  auto secrets = ReadSecrets(settings_);
  if (!secrets.ok()) {
    return Ended({EndReason::kSettings, std::string(secrets.status().message())});
  }
  password_ = std::move(secrets->password);
  link_->Open(settings_.url, secrets->tls);
  OnPhase(LinkPhase::kResolving);
}

void Client::OnPhase(LinkPhase phase) {
  opening_ = phase;
  due_ = parts_.clock.Steady() + WaitOf(phase, settings_.waits);
  Arm();
}

void Client::OnUp() {
  phase_ = Phase::kUp;
  conversation_ = std::make_unique<Conversation>(
      Conversation::Context{settings_, subscriptions_, *this, parts_.probe, parts_.clock},
      Conversation::Beginning{connection_, std::exchange(password_, {}), had_session_});
  if (stopped_reading_) conversation_->StopReading();
  Settle();
}

void Client::OnRead() {
  reading_ = false;
  taken_ = 0;
  conversation_->NoteHeard();
  Settle();
}

void Client::OnWritten() {
  conversation_->Written();
  Settle();
}

void Client::OnDue() {
  armed_ = SteadyTime::max();
  if (phase_ == Phase::kUp) {
    conversation_->Tick();
    return Settle();
  }
  if (parts_.clock.Steady() < due_) return Arm();
  if (phase_ == Phase::kPausing) return Attempt();
  if (phase_ == Phase::kOpening) Ended({EndReason::kTimeout, LateText(opening_)});
}

void Client::OnDown(const End& end) { Ended(end); }

void Client::Settle() {
  if (settling_ || conversation_ == nullptr) return;
  settling_ = true;
  const std::string_view input = reading_ ? std::string_view() : link_->input();
  const std::string_view rest = input.substr(std::min(taken_, input.size()));
  taken_ += conversation_->Take(rest);
  settling_ = false;
  if (phase_ == Phase::kStopped) return Stop();
  if (conversation_->end()) return Ended(End(*conversation_->end()));
  if (std::string output = conversation_->TakeOutput(); !output.empty()) {
    link_->Write(std::move(output));
  }
  if (conversation_->reading() && !reading_) {
    reading_ = true;
    link_->Read();
  }
  Arm();
}

void Client::CloseConnection(std::string farewell) {
  if (conversation_ != nullptr) {
    had_session_ |= settings_.kept_session && conversation_->accepted_at().has_value();
    subscriptions_.End();
  }
  conversation_.reset();
  if (link_ != nullptr) link_->Close(std::move(farewell));
  link_.reset();
  reading_ = false;
  taken_ = 0;
  armed_ = SteadyTime::max();
}

void Client::Ended(const End& end) {
  parts_.probe.CountEnd(end.reason);
  const SteadyTime now = parts_.clock.Steady();
  std::optional<milliseconds> lived;
  if (conversation_ != nullptr && conversation_->accepted_at()) {
    lived = std::chrono::duration_cast<milliseconds>(now - *conversation_->accepted_at());
  }
  // MQTT 5 tells the broker what was wrong with it; 3.1.1 has no way to.
  const std::uint8_t code = settings_.version == Version::k5 ? FarewellCode(end.reason) : 0;
  CloseConnection(lived && code != 0 ? EncodeDisconnect(settings_.version, code) : "");
  const Reconnect::Pause pause = reconnect_.After(end.reason, lived, parts_.random());
  phase_ = Phase::kPausing;
  due_ = now + pause.wait;
  link_ = parts_.make_link(*this);
  NoteError(end.text);
  Show(pause.id_taken ? ClientState::kIdTaken : ClientState::kWaiting);
  parts_.probe.id_taken.Set(pause.id_taken ? 1 : 0);
  if (pause.id_taken) {
    parts_.probe.ids_taken.Add();
    OnTrouble({Trouble::Kind::kIdTaken,
               "another client uses the id, or the broker ends us soon after it accepted us: " +
                   end.text});
  }
  parts_.listener.OnEnded(end, pause.wait);
  if (phase_ == Phase::kPausing) Arm();
}

void Client::Arm() {
  const SteadyTime next = phase_ == Phase::kUp ? conversation_->Next() : due_;
  if (link_ == nullptr || next >= armed_) return;
  armed_ = next;
  link_->WakeAt(next);
}

void Client::OnConnected(const Connected& connected) {
  parts_.probe.id_taken.Set(0);
  const SystemTime now = parts_.clock.System();
  status_.Change([&](ClientStatus& status) {
    status.connected_since = now;
    status.session_present = connected.session_present;
    if (connected.session_lost) status.session_lost_at = now;
  });
  Show(ClientState::kSubscribing);
  parts_.listener.OnConnected(connected);
}

void Client::OnSubscribed() {
  Show(ClientState::kSubscribed);
  parts_.listener.OnSubscribed();
}

void Client::OnTrouble(const Trouble& trouble) {
  NoteError(trouble.text);
  parts_.listener.OnTrouble(trouble);
}

void Client::Show(ClientState state) {
  status_.Change([state](ClientStatus& status) {
    status.state = state;
    if (state == ClientState::kSubscribing || state == ClientState::kSubscribed) return;
    status.connected_since.reset();
    status.session_present = false;
  });
}

void Client::NoteError(const std::string& text) {
  const SystemTime now = parts_.clock.System();
  status_.Change([&](ClientStatus& status) {
    status.last_error = PrintableUtf8(text, kErrorBytesMax);
    status.last_error_at = now;
  });
}

}  // namespace uplink::mqtt
