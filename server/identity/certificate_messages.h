#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include <openssl/types.h>

#include "server/identity/certificate_gate.h"

namespace uplink::identity {

/// The gate for certificates on one connection of TLS. It judges every Certificate message of the
/// peer, a client or a server, by TLS 1.2 or 1.3, before OpenSSL reads it, also one that comes
/// after the handshake.
///
/// OpenSSL reports a whole message and cannot be told to stop. So a message with a flaw is
/// overwritten in OpenSSL's buffer, and the handshake, or the next call that reads,
/// fails (a test, OpenSslMessages, checks that OpenSSL reads the message only then, and there).
///
/// Limits:  kShown... of certificate_gate.h.
/// Thread:  confined to that of the connection.
class CertificateMessages final {
 public:
  /// Takes the connection's message callback, bounds the message's bytes, and turns off what would
  /// let certificates bypass the gate (compressed ones, and TLS 1.2's second handshake). Make it
  /// before the first byte; do not call the connection after it is destroyed.
  explicit CertificateMessages(SSL* connection);
  CertificateMessages(const CertificateMessages&) = delete;
  CertificateMessages& operator=(const CertificateMessages&) = delete;

  /// What is wrong with the certificates that the peer showed; kNone if nothing is.
  [[nodiscard]] CertificateFlaw flaw() const { return flaw_; }
  /// A call on the connection failed; `error` is the earliest in OpenSSL's queue. If it says that a
  /// Certificate message is larger than kShownBytesMax, that is the flaw: OpenSSL does not read
  /// such a message, so the gate never sees it.
  void NoteFailure(unsigned long error);  // NOLINT(google-runtime-int): the library's type
  /// How many handshake messages came since the last call. Once the handshake is over, they are
  /// mostly new keys.
  [[nodiscard]] std::uint32_t TakeCount() { return std::exchange(count_, 0); }

 private:
  static void OnMessage(int written, int version, int type, const void* bytes, std::size_t size,
                        SSL* connection, void* messages);
  void Judge(int version, std::span<std::uint8_t> message);

  SSL* const connection_;
  CertificateFlaw flaw_ = CertificateFlaw::kNone;
  std::uint32_t count_ = 0;
};

}  // namespace uplink::identity
