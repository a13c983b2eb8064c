#include "server/relay/grpc_log.h"

#include <memory>
#include <mutex>
#include <string_view>

#include <grpc/support/log.h>

#include "schema/base/check.h"
#include "server/log/rate_limited.h"

namespace uplink::relay {
namespace {

/// How gRPC 1.51 begins a line about a TLS handshake that failed (ssl_transport_security.cc).
constexpr std::string_view kHandshakeFailed = "Handshake failed";

/// gRPC takes a function without an argument of ours, so that its receiver can only be static.
struct Receiver {
  std::mutex mutex;
  std::unique_ptr<log::RateLimited> lines;
  metrics::Cell* handshakes_failed = nullptr;
};

Receiver& TheReceiver() {
  // Never destroyed: a thread of gRPC may outlive main's return.
  static auto* const receiver = new Receiver();
  return *receiver;
}

void Receive(gpr_log_func_args* line) {
  Receiver& receiver = TheReceiver();
  const std::lock_guard lock(receiver.mutex);
  if (receiver.lines == nullptr) return;
  if (std::string_view(line->message).starts_with(kHandshakeFailed)) {
    receiver.handshakes_failed->Add();
  }
  receiver.lines->Write(log::Level::kWarn, "grpc", {{"text", line->message}});
}

}  // namespace

GrpcLog::GrpcLog(const log::Logger& logger) {
  Receiver& receiver = TheReceiver();
  const std::lock_guard lock(receiver.mutex);
  UPLINK_CHECK(receiver.lines == nullptr, "gRPC's lines have one receiver");
  receiver.lines = std::make_unique<log::RateLimited>(logger);
  receiver.handshakes_failed = &handshakes_failed_;
  gpr_set_log_function(&Receive);
}

GrpcLog::~GrpcLog() {
  Receiver& receiver = TheReceiver();
  const std::lock_guard lock(receiver.mutex);
  receiver.lines.reset();
}

}  // namespace uplink::relay
