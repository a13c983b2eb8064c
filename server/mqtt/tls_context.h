#pragma once

#include <memory>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <openssl/types.h>

#include "server/mqtt/secrets.h"
#include "server/mqtt/settings.h"

namespace uplink::mqtt {

struct SslContextFree {
  void operator()(SSL_CTX* context) const;
};
using SslContext = std::unique_ptr<SSL_CTX, SslContextFree>;

/// What a client's handshakes need: TLS 1.2 or later, a broker's chain that leads to one of our
/// authorities (those of the system if `tls.ca` is empty), and our certificate if there is one.
///
/// Errors:  kFailedPrecondition names the key of the configuration whose text OpenSSL rejects.
/// Thread:  pure; any thread.
[[nodiscard]] absl::StatusOr<SslContext> MakeSslContext(const TlsTexts& tls);

/// Requires the broker to prove that it is `url.host`, a name or an address, and sends the name
/// (SNI; an address has none).
///
/// Errors: kInternal if OpenSSL does not take the name.
[[nodiscard]] absl::Status AskForHost(SSL* connection, const Url& url);

/// Why the broker's certificate was not accepted; empty if it was, or none came.
[[nodiscard]] const char* VerifyText(const SSL* connection);

}  // namespace uplink::mqtt
