#include "server/front/tls/tls_peer.h"

#include <algorithm>
#include <utility>

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include "server/transport/tls_settings.h"

namespace uplink::front {
milliseconds TlsPeer::UntilExpiry(SystemTime now, bool vouched) const {
  return identity.ok() && vouched ? std::min<milliseconds>(expiry - now, kFarAway) : kFarAway;
}

TlsPeer PeerOf(const SSL* connection, int verify_error,
               const identity::AuthorityRules& authorities) {
  X509* certificate = SSL_get0_peer_certificate(connection);
  TlsPeer peer{.anonymous = certificate == nullptr,
               .identity = absl::UnauthenticatedError("client certificate: none was shown"),
               .ruri = {},
               .expiry = SystemTime{}};
  if (certificate == nullptr) return peer;
  peer.certificate = identity::ShownBy(*certificate);
  peer.key = peer.certificate.key_sha256;
  peer.expiry = peer.certificate.not_after;
  const STACK_OF(X509)* chain = SSL_get0_verified_chain(connection);
  for (int i = 0; i < sk_X509_num(chain); ++i) {
    peer.expiry = std::min(peer.expiry, identity::NotAfterOf(*sk_X509_value(chain, i)));
  }
  peer.identity = identity::IdentityOf(*certificate);
  if (peer.identity.ok() && peer.identity->role == identity::Role::kRobot) {
    peer.ruri = peer.identity->ruri;
  } else if (peer.IsGateway()) {
    peer.gateway = peer.identity->gateway.subject;
    // Its own comes first, then those that signed it.
    for (int i = 1; i < sk_X509_num(chain); ++i) {
      peer.identity->gateway.constraints.Add(*sk_X509_value(chain, i));
    }
  } else {
    peer.subject = identity::SubjectOf(*certificate);
  }
  if (peer.identity.ok()) {
    peer.identity->bounds = authorities.BoundsOf(chain);
    if (absl::Status may = authorities.Judge(*peer.identity, connection); !may.ok()) {
      peer.outside_authority = true;
      peer.identity = std::move(may);
    }
  }
  if (verify_error != X509_V_OK) peer.identity = transport::FlawOfTrusted(verify_error);
  ERR_clear_error();
  return peer;
}

}  // namespace uplink::front
