#include "server/front/call/relay_handler.h"

#include <utility>
#include <vector>

#include "server/front/call/outbound.h"
#include "server/front/call/thread.h"

namespace uplink::front {

transport::Methods RelayHandler::Served() {
  transport::Methods methods;
  // Each call that is served here is a Call.
  methods.emplace("/uplink.v1.UplinkRelay/Relay",
                  transport::Method{.kind = transport::MethodKind::kBidirectional,
                                    .roles = {identity::Role::kRobot, identity::Role::kGateway},
                                    .audience = "the relay takes robots and gateways alone",
                                    .serve = [](transport::ServedCall& call) {
                                      return Serve(static_cast<Call&>(call));
                                    }});
  return methods;
}

absl::StatusOr<std::unique_ptr<transport::CallHandler>> RelayHandler::Serve(Call& call) {
  Thread& thread = call.thread();
  std::unique_ptr<RelayHandler> handler(new RelayHandler(call));
  handler->session_.emplace(thread.sessions, session::Peer{call.peer(), call.connection()},
                            call.self(), *handler, *handler);
  thread.debug.StreamOpened(call.stream(), call.owner().origin());
  return handler;
}

void RelayHandler::OnBroken(const transport::Ending& ending) {
  if (session_->done()) return;
  call_.thread().debug.StreamBroken(call_.stream(), call_.owner().origin(), session_->ruri());
  session_->OnBroken(ending);
}

void RelayHandler::Write(const v1::RelayResponse& frame) {
  call_.Write(transport::WithPrefix(frame));
}

void RelayHandler::WriteEncoded(std::span<const session::EncodedFrame> frames) {
  call_.Write(std::vector<SharedMessage>(frames.begin(), frames.end()));
}

void RelayHandler::Finish(const absl::Status& status) {
  Thread& thread = call_.thread();
  Origin origin = call_.owner().origin();
  if (!origin.gateway.empty()) origin.robot = session_->ruri();
  if (session_->unconfirmed()) {
    thread.book.Tell("rejects_unconfirmed", "rejects_unconfirmed", std::string(status.message()),
                     origin, thread.clock.Steady());
  } else {
    thread.book.TellRefusal(status, origin, thread.clock.Steady());
  }
  thread.debug.StreamEnded(call_.stream(), origin, session_->ruri(), status);
  call_.Finish(status);
}

}  // namespace uplink::front
