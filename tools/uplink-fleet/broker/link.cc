#include "tools/uplink-fleet/broker/link.h"

#include <cerrno>
#include <system_error>
#include <utility>

#include <fmt/core.h>
#include <mosquitto.h>

namespace uplink::synthetic {
namespace {

/// From this on a reason code of MQTT 5 is a refusal.
constexpr int kRefusedFrom = 0x80;
/// Verify the broker's certificate.
constexpr int kVerifyPeer = 1;

std::string TextOf(int error) {
  return error == MOSQ_ERR_ERRNO ? std::generic_category().message(errno)
                                 : mosquitto_strerror(error);
}

}  // namespace

struct BrokerLink::Impl {
  Impl(BrokerSettings given, BrokerListener& told) : settings(std::move(given)), listener(told) {}
  ~Impl() {
    if (client != nullptr) mosquitto_destroy(client);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  const BrokerSettings settings;
  BrokerListener& listener;
  mosquitto* client = nullptr;
  bool opened = false;
  /// Why the broker does not let us in; empty if it did not say so.
  std::string refused;

  [[nodiscard]] absl::Status Failed(const char* doing, int error) const {
    return absl::UnavailableError(fmt::format("broker {}:{}: {}: {}", settings.url.host,
                                              settings.url.port, doing, TextOf(error)));
  }
  [[nodiscard]] absl::Status SetUp();

  static Impl& Of(void* self) { return *static_cast<Impl*>(self); }
  static void OnConnect(mosquitto* /*client*/, void* self, int reason, int /*flags*/,
                        const mosquitto_property* /*properties*/) {
    if (reason == 0) return Of(self).listener.OnConnected();
    Of(self).refused = Of(self).settings.version == MqttVersion::k5
                           ? mosquitto_reason_string(reason)
                           : mosquitto_connack_string(reason);
  }
  static void OnPublish(mosquitto* /*client*/, void* self, int id, int reason,
                        const mosquitto_property* /*properties*/) {
    Of(self).listener.OnAcked(id, reason < kRefusedFrom ? "" : mosquitto_reason_string(reason));
  }
  static void OnMessage(mosquitto* /*client*/, void* self, const mosquitto_message* message,
                        const mosquitto_property* /*properties*/) {
    const auto* bytes = static_cast<const char*>(message->payload);
    Of(self).listener.OnMessage(
        message->topic,
        std::string_view(bytes,
                         bytes == nullptr ? 0 : static_cast<std::size_t>(message->payloadlen)));
  }
};

absl::Status BrokerLink::Impl::SetUp() {
  const char* id = settings.client_id.empty() ? nullptr : settings.client_id.c_str();
  client = mosquitto_new(id, true, this);
  if (client == nullptr) return absl::InvalidArgumentError(TextOf(MOSQ_ERR_ERRNO));
  const int version = static_cast<int>(settings.version);
  int error = mosquitto_int_option(client, MOSQ_OPT_PROTOCOL_VERSION, version);
  if (error == 0) error = mosquitto_int_option(client, MOSQ_OPT_SEND_MAXIMUM, kBrokerWindow);
  if (error == 0) error = mosquitto_int_option(client, MOSQ_OPT_TCP_NODELAY, 1);
  if (error == 0 && !settings.username.empty()) {
    error = mosquitto_username_pw_set(client, settings.username.c_str(), settings.password.c_str());
  }
  if (error == 0 && settings.url.tls) {
    error = mosquitto_tls_set(client, settings.ca_file.c_str(), nullptr, nullptr, nullptr, nullptr);
    if (error == 0) error = mosquitto_tls_opts_set(client, kVerifyPeer, nullptr, nullptr);
  }
  if (error != 0) {
    return absl::InvalidArgumentError(fmt::format("the broker's settings: {}", TextOf(error)));
  }
  mosquitto_connect_v5_callback_set(client, &Impl::OnConnect);
  mosquitto_publish_v5_callback_set(client, &Impl::OnPublish);
  mosquitto_message_v5_callback_set(client, &Impl::OnMessage);
  return absl::OkStatus();
}

BrokerLibrary::BrokerLibrary() { mosquitto_lib_init(); }
BrokerLibrary::~BrokerLibrary() { mosquitto_lib_cleanup(); }

absl::StatusOr<std::unique_ptr<BrokerLink>> BrokerLink::Create(const BrokerSettings& settings,
                                                               BrokerListener& listener) {
  auto impl = std::make_unique<Impl>(settings, listener);
  if (absl::Status status = impl->SetUp(); !status.ok()) return status;
  return std::unique_ptr<BrokerLink>(new BrokerLink(std::move(impl)));
}

BrokerLink::BrokerLink(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
BrokerLink::~BrokerLink() = default;

absl::Status BrokerLink::Connect() {
  const config::BrokerUrl& url = impl_->settings.url;
  impl_->refused.clear();
  const int error = impl_->opened ? mosquitto_reconnect(impl_->client)
                                  : mosquitto_connect(impl_->client, url.host.c_str(), url.port,
                                                      kBrokerKeepaliveSeconds);
  impl_->opened = true;
  return error == 0 ? absl::OkStatus() : impl_->Failed("connect", error);
}

absl::Status BrokerLink::Turn(milliseconds wait) {
  const int error = mosquitto_loop(impl_->client, static_cast<int>(wait.count()), 1);
  if (!impl_->refused.empty()) {
    return absl::UnavailableError(fmt::format("the broker does not let us in: {}", impl_->refused));
  }
  return error == 0 ? absl::OkStatus() : impl_->Failed("connection ended", error);
}

bool BrokerLink::HasRoom() const { return !mosquitto_want_write(impl_->client); }

absl::StatusOr<int> BrokerLink::Publish(const Publication& publication) {
  int id = 0;
  const int error = mosquitto_publish_v5(
      impl_->client, &id, publication.topic.c_str(), static_cast<int>(publication.payload.size()),
      publication.payload.data(), static_cast<int>(publication.qos), publication.retain, nullptr);
  // Without a connection what is published at QoS 1 waits for one.
  if (error == 0 || (error == MOSQ_ERR_NO_CONN && publication.qos == Qos::k1)) return id;
  return impl_->Failed("publish", error);
}

absl::Status BrokerLink::Subscribe(const std::string& filter) {
  const int error = mosquitto_subscribe(impl_->client, nullptr, filter.c_str(), 0);
  return error == 0 ? absl::OkStatus() : impl_->Failed("subscribe", error);
}

void BrokerLink::Disconnect() { (void)mosquitto_disconnect(impl_->client); }

}  // namespace uplink::synthetic
