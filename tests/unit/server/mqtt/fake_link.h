#pragma once

#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/mqtt/link.h"

namespace uplink::testing {

/// A link that a test moves by hand. What the client asks of it is kept; events are the test's.
class FakeLink final : public mqtt::Link {
 public:
  explicit FakeLink(mqtt::LinkEvents& events) : events_(&events) {}

  void Open(const mqtt::Url& /*url*/, const mqtt::TlsTexts& /*tls*/) override { opened = true; }
  void Read() override {
    reading = true;
    input_.clear();
  }
  [[nodiscard]] std::string_view input() const override { return input_; }
  [[nodiscard]] std::size_t unread() const override { return unread_bytes; }
  void Write(std::string bytes) override {
    writing = true;
    written += bytes;
  }
  void WakeAt(SteadyTime time) override { wake_at = time; }
  void Close(std::string last) override {
    events_ = nullptr;
    closed = true;
    farewell = std::move(last);
  }

  [[nodiscard]] mqtt::LinkEvents* events() const { return events_; }
  /// The read that is under way brings these.
  void Bring(std::string bytes) {
    reading = false;
    input_ = std::move(bytes);
    events_->OnRead();
  }
  void FinishWrite() {
    writing = false;
    events_->OnWritten();
  }

  std::size_t unread_bytes = 0;
  bool opened = false;
  bool reading = false;
  bool writing = false;
  bool closed = false;
  std::string written;
  std::string farewell;
  SteadyTime wake_at = SteadyTime::max();

 private:
  mqtt::LinkEvents* events_;
  std::string input_;
};

}  // namespace uplink::testing
