#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "server/transport/call_handler.h"

namespace uplink::rpc {

/// The versions of gRPC's reflection that tools ask for. Their messages are the same.
inline constexpr std::array<std::string_view, 2> kReflectionPackages{"grpc.reflection.v1",
                                                                     "grpc.reflection.v1alpha"};
/// Bytes of one question.
inline constexpr std::uint64_t kReflectionBytesMax = 4UL * 1024;

/// One stream of questions about what is served: each is answered in its turn, from the contract
/// that is compiled in.
///
/// Thread: confined to its connection's.
class ReflectionCall final : public transport::CallHandler {
 public:
  explicit ReflectionCall(transport::ServedCall& call) : call_(call) {}

  // transport::CallHandler
  void Start() override { call_.RequestMessage(); }
  [[nodiscard]] std::uint64_t message_bytes_max() const override { return kReflectionBytesMax; }
  void OnMessage(std::string_view bytes) override;
  void OnTooLarge(std::uint64_t bytes) override;
  void OnHalfClose() override { call_.Finish(absl::OkStatus()); }
  void OnBroken(const transport::Ending& /*ending*/) override {}
  void OnWritten() override { call_.RequestMessage(); }
  void OnWake() override {}
  void OnTimer() override {}
  [[nodiscard]] std::optional<SteadyTime> deadline() const override { return std::nullopt; }
  void OnDrain(milliseconds grace) override;

 private:
  transport::ServedCall& call_;
};

}  // namespace uplink::rpc
