#include "server/identity/certificate_messages.h"

#include <algorithm>

#include <openssl/err.h>
#include <openssl/ssl.h>

namespace uplink::identity {
namespace {

/// Bytes of a message's head: one for its type, three for its length.
constexpr std::size_t kMessageHeadBytes = 4;
/// No valid Certificate message begins with this byte: it announces a context that we never asked
/// for, or a list that is longer than a message.
constexpr std::uint8_t kUnreadable = 0xFF;

}  // namespace

CertificateMessages::CertificateMessages(SSL* connection) : connection_(connection) {
  SSL_set_options(connection, SSL_OP_NO_RENEGOTIATION);
#ifdef SSL_OP_NO_RX_CERTIFICATE_COMPRESSION
  // OpenSSL 3.2 and later.
  SSL_set_options(connection, SSL_OP_NO_RX_CERTIFICATE_COMPRESSION);
#endif
  SSL_set_max_cert_list(connection, kShownBytesMax);
  SSL_set_msg_callback(connection, OnMessage);
  SSL_set_msg_callback_arg(connection, this);
}

// NOLINTNEXTLINE(google-runtime-int): the library's type
void CertificateMessages::NoteFailure(unsigned long error) {
  if (ERR_GET_REASON(error) != SSL_R_EXCESSIVE_MESSAGE_SIZE) return;
  const OSSL_HANDSHAKE_STATE state = SSL_get_state(connection_);
  if (state == TLS_ST_SR_CERT || state == TLS_ST_CR_CERT) flaw_ = CertificateFlaw::kBytes;
}

void CertificateMessages::OnMessage(int written, int version, int type, const void* bytes,
                                    std::size_t size, SSL* /*connection*/, void* messages) {
  if (written != 0 || type != SSL3_RT_HANDSHAKE) return;
  auto& self = *static_cast<CertificateMessages*>(messages);
  ++self.count_;
  // OpenSSL's own buffer, which it reads after this returns.
  auto* const own = static_cast<std::uint8_t*>(const_cast<void*>(bytes));
  self.Judge(version, std::span(own, size));
}

void CertificateMessages::Judge(int version, std::span<std::uint8_t> message) {
  if (message.size() < kMessageHeadBytes || message[0] != SSL3_MT_CERTIFICATE) return;
  const auto form = version == TLS1_3_VERSION ? MessageForm::kTls13 : MessageForm::kTls12;
  const std::span<std::uint8_t> body = message.subspan(kMessageHeadBytes);
  const CertificateFlaw flaw = FlawOfMessage(form, body);
  if (flaw == CertificateFlaw::kNone) return;
  flaw_ = flaw;
  std::ranges::fill(body, kUnreadable);
}

}  // namespace uplink::identity
