#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include <openssl/types.h>

#include "server/identity/certificate_gate.h"

namespace uplink::identity {

/// The gate for certificates on one connection of TLS: every Certificate message of the peer is
/// judged before OpenSSL reads it, also one that comes after the handshake, of a client and of a
/// server, by TLS 1.2 and 1.3.
///
/// OpenSSL reports a whole message and cannot be told to stop: a message with a flaw is made
/// unreadable where it stands, so that the handshake, or the next call that reads,
/// fails (OpenSslMessages, a test, holds that OpenSSL reads the message only then, and there).
///
/// Limits:  kShown... of certificate_gate.h.
/// Thread:  confined to that of the connection.
class CertificateMessages final {
 public:
  /// All that the gate needs: it takes the connection's message callback, bounds the message's
  /// bytes, and turns off what would let certificates pass by it (compressed ones, and TLS 1.2's
  /// second handshake). Before the first byte; the connection makes no more calls once this is
  /// gone.
  explicit CertificateMessages(SSL* connection);
  CertificateMessages(const CertificateMessages&) = delete;
  CertificateMessages& operator=(const CertificateMessages&) = delete;

  /// What is wrong with certificates that the peer showed; kNone if nothing was.
  [[nodiscard]] CertificateFlaw flaw() const { return flaw_; }
  /// A call on the connection failed; `error` is the earliest in OpenSSL's queue. It may say that a
  /// Certificate message is larger than kShownBytesMax: OpenSSL does not read such a message, so
  /// the gate never sees it.
  void NoteFailure(unsigned long error);  // NOLINT(google-runtime-int): the library's type
  /// Whole messages of the handshake's kind that came since the last call: once the handshake is
  /// over, new keys mostly.
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
