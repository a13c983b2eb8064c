#include "server/front/tls/tls_engine.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include "schema/base/check.h"
#include "server/transport/tls_settings.h"

namespace uplink::front {

using transport::TurnedAway;

namespace {

TlsBuffers& BuffersOf(BIO* bio) { return *static_cast<TlsBuffers*>(BIO_get_data(bio)); }

int ReadBuffers(BIO* bio, char* into, int size) {
  BIO_clear_retry_flags(bio);
  std::string_view& in = BuffersOf(bio).in;
  if (in.empty()) {
    BIO_set_retry_read(bio);
    return -1;
  }
  const std::size_t taken = std::min(in.size(), static_cast<std::size_t>(size));
  std::memcpy(into, in.data(), taken);
  in.remove_prefix(taken);
  return static_cast<int>(taken);
}

int WriteBuffers(BIO* bio, const char* bytes, int size) {
  BIO_clear_retry_flags(bio);
  BuffersOf(bio).out.append(bytes, static_cast<std::size_t>(size));
  return size;
}

// NOLINTNEXTLINE(google-runtime-int): the library's type
long ControlBuffers(BIO* /*bio*/, int command, long /*number*/, void* /*pointer*/) {
  return command == BIO_CTRL_FLUSH ? 1 : 0;
}

int CreateBuffers(BIO* bio) {
  BIO_set_init(bio, 1);
  return 1;
}

SSL* New(const TlsContext& context) {
  SSL* ssl = SSL_new(context.get());
  UPLINK_CHECK(ssl != nullptr, "out of memory");
  return ssl;
}

}  // namespace

BufferMethod::BufferMethod()
    : method_(BIO_meth_new(BIO_get_new_index() | BIO_TYPE_SOURCE_SINK, "uplinkd buffers")) {
  UPLINK_CHECK(method_ != nullptr, "out of memory");
  BIO_meth_set_read(method_, ReadBuffers);
  BIO_meth_set_write(method_, WriteBuffers);
  BIO_meth_set_ctrl(method_, ControlBuffers);
  BIO_meth_set_create(method_, CreateBuffers);
}

BufferMethod::~BufferMethod() { BIO_meth_free(method_); }

TlsEngine::TlsEngine(std::shared_ptr<const TlsContext> context, const BufferMethod& method,
                     TlsBuffers& buffers)
    : context_(std::move(context)), buffers_(buffers), ssl_(New(*context_)), messages_(ssl_) {
  BIO* bio = BIO_new(method.get());
  UPLINK_CHECK(bio != nullptr, "out of memory");
  BIO_set_data(bio, &buffers_);
  SSL_set_bio(ssl_, bio, bio);
  SSL_set_app_data(ssl_, this);
  // Read returns after each handshake message between pieces of the peer's data.
  SSL_clear_mode(ssl_, SSL_MODE_AUTO_RETRY);
  SSL_set_accept_state(ssl_);
}

TlsEngine::~TlsEngine() { SSL_free(ssl_); }

int TlsEngine::OnVerified(int good, X509_STORE_CTX* store) {
  if (good == 1) return 1;
  const int error = X509_STORE_CTX_get_error(store);
  if (!transport::IsTrusted(error, X509_STORE_CTX_get_error_depth(store))) return 0;
  const auto* ssl = static_cast<const SSL*>(
      X509_STORE_CTX_get_ex_data(store, SSL_get_ex_data_X509_STORE_CTX_idx()));
  auto* engine = static_cast<TlsEngine*>(SSL_get_app_data(ssl));
  if (engine->verify_error_ == X509_V_OK) engine->verify_error_ = error;
  return 1;
}

int TlsEngine::OnClientHello(SSL* connection, int* /*alert*/, void* /*argument*/) {
  static_cast<TlsEngine*>(SSL_get_app_data(connection))->buffers_.offer = ClientOffer(connection);
  return SSL_CLIENT_HELLO_SUCCESS;
}

// The texts say these.
static_assert(kClientHelloBytesMax == std::size_t{4} * 1024 && kHandshakeReadsMax == 128 &&
              kHandshakeBytesMax == std::size_t{48} * 1024);

TlsEngine::Step TlsEngine::Handshake() {
  begun_ = begun_ || !buffers_.in.empty();
  if (!buffers_.in.empty()) ++handshake_reads_;
  hello_.Take(buffers_.in);
  if (hello_.size() > kClientHelloBytesMax) {
    return Fail(Failure::kOther, "a first message of over 4 KiB");
  }
  if (handshake_reads_ > kHandshakeReadsMax) {
    return Fail(Failure::kOther, "a handshake in over 128 pieces");
  }
  ERR_clear_error();
  buffers_.offer = {};
  const int result = Advance();
  const bool flawed = messages_.flaw() != identity::CertificateFlaw::kNone;
  if (!flawed && result != 1 && SSL_get_error(ssl_, result) == SSL_ERROR_WANT_READ) {
    if (buffers_.in.empty()) return Step::kMore;
    return Fail(Failure::kOther, "a handshake of over 48 KiB");
  }
  if (flawed || result != 1) return FailByOpenSsl();
  const unsigned char* protocol = nullptr;
  unsigned int size = 0;
  SSL_get0_alpn_selected(ssl_, &protocol, &size);
  // It offered none at all; an unknown one failed before.
  if (size == 0) return FailToAgree(Agreed::kProtocol);
  static_cast<void>(messages_.TakeCount());
  return Step::kDone;
}

int TlsEngine::Advance() {
  const std::string_view came = buffers_.in;
  const std::string_view offered = came.substr(0, kHandshakeBytesMax - handshake_bytes_);
  buffers_.in = offered;
  const int result = SSL_do_handshake(ssl_);
  const std::size_t taken = offered.size() - buffers_.in.size();
  handshake_bytes_ += taken;
  buffers_.in = came.substr(taken);
  return result;
}

TlsEngine::Step TlsEngine::Fail(Failure failure, std::string detail) {
  failure_ = failure;
  detail_ = std::move(detail);
  ERR_clear_error();
  return Step::kFailed;
}

TlsEngine::Step TlsEngine::FailToAgree(Agreed what) {
  return Fail(Failure::kNothingShared, buffers_.offer.WhyNot(what, ssl_, context_->rules()));
}

TlsEngine::Step TlsEngine::FailByOpenSsl() {
  unsigned long error = ERR_peek_error();  // NOLINT(google-runtime-int): the library's type
  messages_.NoteFailure(error);
  if (messages_.flaw() != identity::CertificateFlaw::kNone) {
    return Fail(Failure::kCertificate, std::string(identity::TextOf(messages_.flaw())));
  }
  // An earlier error says what was wrong with the chain, such as a foreign signature.
  const unsigned long last = ERR_peek_last_error();  // NOLINT(google-runtime-int): as above
  if (ERR_GET_REASON(last) == SSL_R_CERTIFICATE_VERIFY_FAILED) error = last;
  switch (ERR_GET_REASON(error)) {
    case SSL_R_WRONG_VERSION_NUMBER:
    case SSL_R_HTTP_REQUEST:
    case SSL_R_HTTPS_PROXY_REQUEST:
    case SSL_R_PACKET_LENGTH_TOO_LONG:
    case SSL_R_BAD_RECORD_TYPE:
      return Fail(Failure::kNoTls);
    case SSL_R_UNSUPPORTED_PROTOCOL:
      return FailToAgree(Agreed::kVersion);
    case SSL_R_NO_SHARED_CIPHER:
      return FailToAgree(Agreed::kSuite);
    case SSL_R_NO_SUITABLE_KEY_SHARE:
      return FailToAgree(Agreed::kGroup);
    case SSL_R_NO_SHARED_SIGNATURE_ALGORITHMS:
    case SSL_R_NO_SUITABLE_SIGNATURE_ALGORITHM:
      return FailToAgree(Agreed::kSignature);
    case SSL_R_NO_APPLICATION_PROTOCOL:
      return FailToAgree(Agreed::kProtocol);
    case SSL_R_PEER_DID_NOT_RETURN_A_CERTIFICATE:
      return Fail(Failure::kNoCertificate);
    case SSL_R_CERTIFICATE_VERIFY_FAILED:
      return Fail(Failure::kUntrusted, X509_verify_cert_error_string(SSL_get_verify_result(ssl_)));
    default:  // the library has hundreds
      return Fail(Failure::kOther);
  }
}

std::optional<std::string_view> TlsEngine::Read() {
  if (late_messages_ > 0 || over_) return TakeLate();
  const int size = static_cast<int>(buffers_.plain.size());
  const int result = SSL_read(ssl_, buffers_.plain.data(), size);
  late_messages_ = messages_.TakeCount();
  if (result > 0) {
    return std::string_view(buffers_.plain.data(), static_cast<std::size_t>(result));
  }
  over_ = SSL_get_error(ssl_, result) != SSL_ERROR_WANT_READ;
  if (over_) ERR_clear_error();
  return TakeLate();
}

std::optional<std::string_view> TlsEngine::TakeLate() {
  if (late_messages_ == 0) return std::nullopt;
  --late_messages_;
  return std::string_view();
}

bool TlsEngine::Write(std::string_view plain) {
  while (!plain.empty()) {
    const int size = static_cast<int>(std::min(plain.size(), kRecordBytes));
    const int written = SSL_write(ssl_, plain.data(), size);
    if (written <= 0) {
      ERR_clear_error();
      return false;
    }
    plain.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

void TlsEngine::WriteEnd() {
  SSL_shutdown(ssl_);
  ERR_clear_error();
}

TurnedAway CauseOf(TlsEngine::Failure failure) {
  switch (failure) {
    case TlsEngine::Failure::kNoTls:
      return TurnedAway::kNoTls;
    case TlsEngine::Failure::kNothingShared:
      return TurnedAway::kNothingShared;
    case TlsEngine::Failure::kNoCertificate:
      return TurnedAway::kNoCertificate;
    case TlsEngine::Failure::kUntrusted:
      return TurnedAway::kUntrusted;
    case TlsEngine::Failure::kCertificate:
      return TurnedAway::kCertificate;
    case TlsEngine::Failure::kNone:
    case TlsEngine::Failure::kOther:
      return TurnedAway::kHandshakeError;
  }
  return TurnedAway::kHandshakeError;
}

}  // namespace uplink::front
