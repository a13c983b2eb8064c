#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "tests/bench/load/client.h"
#include "tests/bench/load/mqtt.h"
#include "tests/bench/load/nats.h"

namespace uplink::bench {

/// A client that speaks a protocol of its own on a TLS connection.
class ByteClient : public Client, private link::LinkEvents {
 public:
  ByteClient(link::Loop& loop, link::LinkOptions options, ClientStyle style)
      : style_(std::move(style)),
        link_(std::make_shared<link::TlsLink>(loop, std::move(options),
                                              static_cast<link::LinkEvents&>(*this))) {
    link_->Connect();
  }
  ~ByteClient() override { link_->Close(); }
  ByteClient(const ByteClient&) = delete;
  ByteClient& operator=(const ByteClient&) = delete;

  [[nodiscard]] std::size_t unsent() const override { return link_->unsent(); }

 protected:
  /// The connection is up: says hello.
  virtual void Greet() = 0;
  /// Takes whole answers from the front of `in_`.
  virtual void TakeAnswers(std::string& in) = 0;
  void Write(std::string_view bytes) { link_->Write(bytes); }
  /// The payload of the next message; valid until the next call.
  [[nodiscard]] const std::string& NextPayload() {
    style_.write(++sent_, payload_);
    return payload_;
  }
  [[nodiscard]] const ClientStyle& style() const { return style_; }

 private:
  void OnUp() override { Greet(); }
  void OnBytes(std::string_view bytes) override {
    in_.append(bytes);
    TakeAnswers(in_);
    Moved();
  }
  void OnSent() override { Moved(); }
  void OnDown(const absl::Status& why) override { Fail(std::string(why.message())); }

  const ClientStyle style_;
  std::shared_ptr<link::TlsLink> link_;
  std::string in_;
  std::string payload_;
};

/// Length, then payloads; the server answers with how many messages it took.
class LengthPrefixClient final : public ByteClient {
 public:
  using ByteClient::ByteClient;
  void Send(std::size_t messages) override;

 private:
  void Greet() override { ready_ = true; }
  void TakeAnswers(std::string& in) override;

  std::string out_;
};

/// MQTT 3.1.1. At QoS 1 each message has a packet and an acknowledgement of its own.
class MqttClient final : public ByteClient {
 public:
  MqttClient(link::Loop& loop, link::LinkOptions options, ClientStyle style, bool acknowledges)
      : ByteClient(loop, std::move(options), std::move(style)), acknowledges_(acknowledges) {}
  void Send(std::size_t messages) override;

 private:
  void Greet() override;
  void TakeAnswers(std::string& in) override;
  void Take(const MqttPacket& packet);

  const bool acknowledges_;
  std::string out_;
  /// Of what came; they leave together.
  std::string acknowledgements_;
  std::uint16_t packet_ = 0;
};

/// NATS core: no acknowledgement of messages; a PING after each 64 tells how far the server is.
class NatsClient final : public ByteClient {
 public:
  using ByteClient::ByteClient;
  void Send(std::size_t messages) override;

 private:
  void Greet() override;
  void TakeAnswers(std::string& in) override;
  void Take(const NatsSaid& said);

  std::string out_;
};

}  // namespace uplink::bench
