#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "schema/base/check.h"
#include "server/transport/call_handler.h"
#include "uncrew/v1/avatar.pb.h"

namespace uplink::simulation {

/// How a call of a drone ended. A value.
struct CallEnd {
  absl::Status status;
  /// Means something if the status is OK.
  ::uncrew::v1::PublishResponse response{};

  [[nodiscard]] bool Is(::uncrew::v1::Outcome outcome) const {
    return status.ok() && response.outcome() == outcome;
  }
};

/// `STORED`, or the code of the status.
[[nodiscard]] inline std::string ToText(const CallEnd& end) {
  if (!end.status.ok()) return absl::StatusCodeToString(end.status.code());
  return ::uncrew::v1::Outcome_Name(end.response.outcome()).substr(sizeof("OUTCOME_") - 1);
}

/// A call of a drone as its handler sees it, without a wire.
///
/// Thread: confined to its caller.
class SimCall final : public transport::ServedCall {
 public:
  SimCall(identity::PeerIdentity peer, loop::StreamRef self)
      : peer_(std::move(peer)), self_(self) {}

  /// Nothing while it is served.
  [[nodiscard]] const std::optional<CallEnd>& end() const { return end_; }

  // transport::ServedCall
  void RequestMessage() override {}
  void Write(std::string message_with_prefix) override {
    UPLINK_CHECK(response_.ParseFromString(message_with_prefix.substr(transport::kPrefixBytes)),
                 "an answer is a PublishResponse");
  }
  void Write(std::vector<transport::SharedMessage> /*messages*/) override {}
  void Finish(const absl::Status& status) override {
    UPLINK_CHECK(!end_, "a call ends once");
    end_ = CallEnd{status, response_};
  }
  void FinishRefused(const absl::Status& status) override { Finish(status); }
  void Cancel() override { Finish(absl::CancelledError("the handler said so")); }
  void AskPeer() override {}
  [[nodiscard]] const identity::PeerIdentity& peer() const override { return peer_; }
  [[nodiscard]] std::optional<SteadyTime> give_up_at() const override { return std::nullopt; }
  [[nodiscard]] loop::StreamRef self() const override { return self_; }

 private:
  const identity::PeerIdentity peer_;
  const loop::StreamRef self_;
  ::uncrew::v1::PublishResponse response_;
  std::optional<CallEnd> end_;
};

}  // namespace uplink::simulation
