#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "schema/base/clock.h"
#include "server/health/monitor.h"
#include "server/rpc/probe.h"
#include "server/rpc/unary_call.h"
#include "server/transport/call_handler.h"
#include "server/transport/methods.h"

namespace uplink::rpc {

/// How often a watch of the health looks whether it has changed.
inline constexpr std::chrono::seconds kHealthLook{1};
/// Bytes of a request about health: the name of a service.
inline constexpr std::uint64_t kHealthBytesMax = 512;

/// gRPC's health service: the server serves while /readyz says so. Anyone may ask, so its calls
/// take no place of those that show who calls (transport::Admission::kHealth).
[[nodiscard]] transport::Methods HealthMethods(const health::Monitor& monitor, RpcProbe& probe,
                                               const Clock& clock);

/// One Check of the health: answered on the connection's thread, once its request is there.
///
/// Thread: confined to its connection's.
class HealthCheck final : public transport::CallHandler {
 public:
  HealthCheck(const health::Monitor& monitor, transport::ServedCall& call, const Clock& clock)
      : monitor_(monitor), call_(call), clock_(clock) {}

  // transport::CallHandler
  void Start() override;
  [[nodiscard]] std::uint64_t message_bytes_max() const override { return kHealthBytesMax; }
  void OnMessage(std::string_view bytes) override;
  void OnTooLarge(std::uint64_t bytes) override;
  void OnHalfClose() override {}
  void OnBroken(const transport::Ending& /*ending*/) override { end_by_.reset(); }
  void OnWritten() override {}
  void OnWake() override {}
  void OnTimer() override;
  [[nodiscard]] std::optional<SteadyTime> deadline() const override { return end_by_; }
  void OnDrain(milliseconds grace) override;

 private:
  void Finish(const absl::Status& status);

  const health::Monitor& monitor_;
  transport::ServedCall& call_;
  const Clock& clock_;
  /// Until when the request must come; nothing once it is answered.
  std::optional<SteadyTime> end_by_;
};

/// One Watch of the health: how it is, then each change.
///
/// Thread: confined to its connection's.
class HealthWatch final : public transport::CallHandler {
 public:
  HealthWatch(const health::Monitor& monitor, transport::ServedCall& call, const Clock& clock)
      : monitor_(monitor), call_(call), clock_(clock) {}

  // transport::CallHandler
  void Start() override;
  [[nodiscard]] std::uint64_t message_bytes_max() const override { return kHealthBytesMax; }
  void OnMessage(std::string_view bytes) override;
  void OnTooLarge(std::uint64_t bytes) override;
  void OnHalfClose() override {}
  void OnBroken(const transport::Ending& /*ending*/) override {}
  void OnWritten() override { writing_ = false; }
  void OnWake() override {}
  void OnTimer() override;
  [[nodiscard]] std::optional<SteadyTime> deadline() const override { return look_at_; }
  void OnDrain(milliseconds grace) override;

 private:
  /// Tells how it is if the peer has not heard that.
  void Look();

  const health::Monitor& monitor_;
  transport::ServedCall& call_;
  const Clock& clock_;
  std::optional<std::string> service_;
  /// Of HealthCheckResponse; what was told last.
  std::optional<int> told_;
  bool writing_ = false;
  std::optional<SteadyTime> look_at_;
};

}  // namespace uplink::rpc
