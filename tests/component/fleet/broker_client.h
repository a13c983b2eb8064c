#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "schema/base/check.h"
#include "schema/base/clock.h"
#include "tests/support/eventually.h"
#include "tools/uplink-fleet/broker/link.h"

namespace uplink::testing {

/// A test's own client of a broker, that keeps what it is told. Confined to one thread.
class BrokerClient final : public synthetic::BrokerListener {
 public:
  struct Message {
    std::string topic;
    std::string payload;
  };

  explicit BrokerClient(const synthetic::BrokerSettings& settings) {
    auto link = synthetic::BrokerLink::Create(settings, *this);
    UPLINK_CHECK(link.ok(), std::string(link.status().message()));
    link_ = *std::move(link);
    status_ = link_->Connect();
    (void)Until([this] { return connected_ || !status_.ok(); });
  }

  /// True once the broker let this client in.
  [[nodiscard]] bool connected() const { return connected_; }
  [[nodiscard]] const absl::Status& status() const { return status_; }
  [[nodiscard]] const std::vector<Message>& messages() const { return messages_; }

  /// Goes on until `condition` holds; false after the usual patience, or if the connection ends.
  bool Until(const std::function<bool()>& condition) {
    const SystemClock clock;
    const SteadyTime end = clock.Steady() + kPatience;
    while (!condition()) {
      if (!status_.ok() || clock.Steady() >= end) return false;
      status_ = link_->Turn(milliseconds(10));
    }
    return true;
  }

  void Subscribe(const std::string& filter) {
    UPLINK_CHECK(link_->Subscribe(filter).ok(), "a test's filter is good");
  }

  /// Publishes at QoS 1; what the broker says of it, empty if it took it.
  [[nodiscard]] std::string Publish(const std::string& topic, const std::string& payload) {
    const auto id = link_->Publish(
        {.topic = topic, .payload = payload, .qos = synthetic::Qos::k1, .retain = false});
    UPLINK_CHECK(id.ok(), "a test's publication is good");
    if (!Until([&] { return answers_.contains(*id); })) return "no answer";
    return answers_[*id];
  }

  void OnConnected() override { connected_ = true; }
  void OnAcked(int id, std::string_view refused) override { answers_[id] = refused; }
  void OnMessage(std::string_view topic, std::string_view payload) override {
    messages_.push_back({std::string(topic), std::string(payload)});
  }

 private:
  std::unique_ptr<synthetic::BrokerLink> link_;
  absl::Status status_;
  bool connected_ = false;
  std::map<int, std::string> answers_;
  std::vector<Message> messages_;
};

}  // namespace uplink::testing
