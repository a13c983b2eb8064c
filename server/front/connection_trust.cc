// Whether a connection's certificate may come in, and stay.
#include <cstddef>
#include <utility>

#include <absl/status/status.h>

#include "server/front/call/thread.h"
#include "server/front/connection.h"
#include "server/identity/deny_list.h"
#include "server/transport/end_cause.h"
#include "server/transport/turned_away.h"

namespace uplink::front {

using transport::Denied;
using transport::EndCause;

TlsPeer Connection::JudgedPeer() {
  TlsPeer peer = tls_->Peer();
  // Authorities that changed during the handshake look at open connections alone.
  if (served_ != nullptr && peer.identity.ok()) {
    absl::Status may = tls_->JudgeAgain(*served_->get(), *peer.identity);
    if (!may.ok()) {
      peer.outside_authority = true;
      peer.identity = std::move(may);
    }
  }
  if (peer.outside_authority) CountDenied(Denied::kAuthority);
  if (IsDenied(peer)) {
    peer.identity = transport::CertificateRevoked();
    CountDenied(Denied::kRevoked);
  }
  return peer;
}

bool Connection::MayBeBanned() const {
  return phase_ == Phase::kOpen && grpc_->tls_peer().identity.ok() && !grpc_->banned();
}

void Connection::LookAtDenied() {
  if (!MayBeBanned() || !IsDenied(grpc_->tls_peer())) return;
  CountDenied(Denied::kEnded);
  grpc_->Ban(transport::CertificateRevoked(), EndCause::kRevoked);
  Settle();
}

void Connection::LookAtAuthorities(const TlsContext& now) {
  if (!MayBeBanned()) return;
  const absl::Status may = tls_->JudgeAgain(now, *grpc_->tls_peer().identity);
  if (may.ok()) return;
  CountDenied(Denied::kAuthority);
  grpc_->Ban(may, EndCause::kNotAllowed);
  Settle();
}

bool Connection::IsDenied(const TlsPeer& peer) const {
  const identity::DenyList* const denied = thread_.relay.denied;
  return denied != nullptr && tls_->IsDenied(*denied->Get(), peer);
}

void Connection::CountDenied(Denied why) {
  thread_.relay.probe.denied_total[static_cast<std::size_t>(why)].Add();
}

}  // namespace uplink::front
