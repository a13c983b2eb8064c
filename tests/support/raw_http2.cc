#include "tests/support/raw_http2.h"

#include <algorithm>
#include <memory>

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>

#include "schema/base/check.h"
#include "server/identity/pem.h"
#include "tests/support/openssl_owners.h"

namespace uplink::testing {
namespace {

constexpr int kAlertCloseNotify = 0;
constexpr std::size_t kPlainBytes = 16 * 1024;
/// Of a stream and of the connection, until the peer says otherwise.
constexpr std::uint64_t kWindowDefault = 65'535;

/// By OpenSSL alone: a test may show what the server's own reader takes from no file.
void UseIdentity(SSL_CTX* context, const KeyPair& pair) {
  if (pair.certificate.empty()) return;
  const std::unique_ptr<BIO, FreeWith<BIO_free>> text(
      BIO_new_mem_buf(pair.certificate.data(), static_cast<int>(pair.certificate.size())));
  const auto next = [&text] {
    return std::unique_ptr<X509, FreeWith<X509_free>>(
        PEM_read_bio_X509(text.get(), nullptr, nullptr, nullptr));
  };
  bool used = SSL_CTX_use_certificate(context, next().get()) == 1;
  while (const auto above = next()) used = used && SSL_CTX_add1_chain_cert(context, above.get());
  ERR_clear_error();
  UPLINK_CHECK(used && identity::UseKey(context, pair.key), "a key pair of the test's own");
}

void SawMessage(int is_sent, int /*version*/, int content_type, const void* bytes, std::size_t size,
                SSL* /*ssl*/, void* alert) {
  if (is_sent == 1 || content_type != SSL3_RT_ALERT || size < 2) return;
  const int description = static_cast<const unsigned char*>(bytes)[1];
  if (description == kAlertCloseNotify) return;
  *static_cast<std::optional<int>*>(alert) = description;
}

/// All that waits in a BIO in memory.
std::string Drain(BIO* bio) {
  std::string bytes(BIO_ctrl_pending(bio), '\0');
  if (!bytes.empty()) BIO_read(bio, bytes.data(), static_cast<int>(bytes.size()));
  return bytes;
}

}  // namespace

struct RawHttp2::Tls {
  explicit Tls(const Options& options) : context(SSL_CTX_new(TLS_client_method())) {
    UPLINK_CHECK(context != nullptr, "OpenSSL has memory");
    const auto authorities = identity::ReadCertificates({"the authority", options.server_ca});
    UPLINK_CHECK(authorities.ok() && X509_STORE_add_cert(SSL_CTX_get_cert_store(context.get()),
                                                         authorities->front().get()) == 1,
                 "an authority of the test's own");
    SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, nullptr);
    SSL_CTX_set_max_proto_version(context.get(), options.tls_max);
    if (!options.suites_of_12.empty()) {
      SSL_CTX_set_cipher_list(context.get(), options.suites_of_12.c_str());
    }
    UseIdentity(context.get(), options.identity);
    if (options.behind != nullptr) options.behind->AddTo(context.get());
    std::string offer;
    for (const std::string& protocol : options.protocols) {
      offer += static_cast<char>(protocol.size());
      offer += protocol;
    }
    ssl.reset(SSL_new(context.get()));
    if (!offer.empty()) {
      SSL_set_alpn_protos(ssl.get(), reinterpret_cast<const unsigned char*>(offer.data()),
                          static_cast<unsigned int>(offer.size()));
    }
    in = BIO_new(BIO_s_mem());
    out = BIO_new(BIO_s_mem());
    SSL_set_bio(ssl.get(), in, out);
    SSL_set_connect_state(ssl.get());
  }

  SslContext context;
  Ssl ssl;
  /// Both are the ssl's.
  BIO* in = nullptr;
  BIO* out = nullptr;
};

RawHttp2::RawHttp2(const Options& options)
    : patience_(options.patience),
      tcp_(options.port, options.source),
      tls_(std::make_unique<Tls>(options)) {
  SSL_set_msg_callback(tls_->ssl.get(), SawMessage);
  SSL_set_msg_callback_arg(tls_->ssl.get(), &alert_);
  if (options.at_first) options.at_first(tcp_);
  out_ = options.before_tls;
  Handshake(SystemClock{}.Steady() + patience_);
}

RawHttp2::~RawHttp2() = default;

void RawHttp2::Handshake(SteadyTime deadline) {
  for (;;) {
    const int result = SSL_do_handshake(tls_->ssl.get());
    const int error = SSL_get_error(tls_->ssl.get(), result);
    ERR_clear_error();
    out_ += Drain(tls_->out);
    if (!Flush(deadline)) return;
    handshaken_ = result == 1;
    if (handshaken_ || error != SSL_ERROR_WANT_READ) return;
    if (end() != RawTcp::End::kNone || !tcp_.Wait(RawTcp::For::kInput, deadline)) return;
    const std::string bytes = tcp_.Receive();
    BIO_write(tls_->in, bytes.data(), static_cast<int>(bytes.size()));
  }
}

std::string RawHttp2::protocol() const {
  const unsigned char* name = nullptr;
  unsigned int size = 0;
  SSL_get0_alpn_selected(tls_->ssl.get(), &name, &size);
  return {reinterpret_cast<const char*>(name), size};
}

// --- To the peer ---

bool RawHttp2::Flush(SteadyTime deadline) {
  while (!out_.empty()) {
    const std::size_t sent = tcp_.SendSome(out_);
    out_.erase(0, sent);
    if (sent > 0) continue;
    if (end() == RawTcp::End::kReset) return false;
    if (!tcp_.Wait(RawTcp::For::kInputOrOutput, deadline)) return false;
    // A peer that waits for us to read would take nothing.
    if (handshaken_) ReceiveOnce();
  }
  return true;
}

bool RawHttp2::Send(std::string_view bytes) {
  while (!bytes.empty()) {
    if (!handshaken_ || end() == RawTcp::End::kReset) return false;
    const std::string_view part = bytes.substr(0, kPlainBytes);
    bytes.remove_prefix(part.size());
    if (SSL_write(tls_->ssl.get(), part.data(), static_cast<int>(part.size())) <= 0) return false;
    out_ += Drain(tls_->out);
    if (!Flush(SystemClock{}.Steady() + std::min(kSendPatience, patience_))) return false;
  }
  return true;
}

std::size_t RawHttp2::WindowOf(std::uint32_t stream) const {
  const auto initial = settings().find(http2::kInitialWindowSize);
  const std::uint64_t of_stream =
      (initial == settings().end() ? kWindowDefault : initial->second) + At(stream).window_given;
  const auto sent = sent_.find(stream);
  return static_cast<std::size_t>(std::min(of_stream - (sent == sent_.end() ? 0 : sent->second),
                                           kWindowDefault + window_given() - sent_in_all_));
}

std::size_t RawHttp2::SendData(std::uint32_t stream, std::string_view bytes,
                               std::chrono::milliseconds patience) {
  const SteadyTime deadline = SystemClock{}.Steady() + patience;
  std::size_t done = 0;
  while (done < bytes.size()) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(deadline - SystemClock{}.Steady());
    if (!ReadUntil([this, stream] { return WindowOf(stream) > 0 || At(stream).over(); }, left)) {
      break;
    }
    const std::string_view part =
        bytes.substr(done, std::min(WindowOf(stream), Http2Answers::kFrameBytesMax));
    if (part.empty() || !Send(http2::Data(stream, part))) break;
    done += part.size();
    sent_[stream] += part.size();
    sent_in_all_ += part.size();
  }
  return done;
}

bool RawHttp2::UpdateKeys(std::size_t times) {
  for (std::size_t i = 0; i < times; ++i) {
    if (!open() || SSL_key_update(tls_->ssl.get(), SSL_KEY_UPDATE_NOT_REQUESTED) != 1 ||
        SSL_do_handshake(tls_->ssl.get()) != 1) {
      return false;
    }
    out_ += Drain(tls_->out);
    if (!Flush(SystemClock{}.Steady() + std::min(kSendPatience, patience_))) return false;
  }
  return true;
}

bool RawHttp2::EndTls() {
  if (!open() || SSL_shutdown(tls_->ssl.get()) < 0) return false;
  out_ += Drain(tls_->out);
  return Flush(SystemClock{}.Steady() + std::min(kSendPatience, patience_));
}

bool RawHttp2::SendPlain(std::string_view bytes) {
  out_ += bytes;
  return Flush(SystemClock{}.Steady() + std::min(kSendPatience, patience_));
}

bool RawHttp2::Begin(const std::vector<std::pair<std::uint16_t, std::uint32_t>>& settings) {
  if (!Send(http2::Preface() + http2::Settings(settings))) return false;
  if (!ReadUntil([this] { return answers_.settings_came(); }, patience_)) return false;
  return Send(http2::SettingsAck());
}

// --- From the peer ---

bool RawHttp2::ReadUntil(const std::function<bool()>& condition,
                         std::chrono::milliseconds patience) {
  const SteadyTime deadline = SystemClock{}.Steady() + patience;
  while (!condition()) {
    if (end() != RawTcp::End::kNone) return false;
    if (!tcp_.Wait(RawTcp::For::kInput, deadline)) return false;
    ReceiveOnce();
  }
  return true;
}

bool RawHttp2::ReadUntilEnd(std::chrono::milliseconds patience) {
  return ReadUntil([this] { return end() != RawTcp::End::kNone; }, patience);
}

bool RawHttp2::Sync() {
  const std::size_t before = pongs();
  return Send(http2::Ping()) && ReadUntil([this, before] { return pongs() > before; });
}

void RawHttp2::ReceiveOnce() {
  const std::string bytes = tcp_.Receive();
  BIO_write(tls_->in, bytes.data(), static_cast<int>(bytes.size()));
  if (handshaken_) Decrypt();
}

void RawHttp2::Decrypt() {
  std::array<char, kPlainBytes> plain{};
  for (;;) {
    const int size = SSL_read(tls_->ssl.get(), plain.data(), static_cast<int>(plain.size()));
    if (size <= 0) break;
    answers_.Add({plain.data(), static_cast<std::size_t>(size)});
  }
  ERR_clear_error();
  out_ += Drain(tls_->out);
}

std::optional<std::uint32_t> RawHttp2::goaway_code() const {
  if (goaways().empty()) return std::nullopt;
  return goaways().front().code;
}

std::string RawHttp2::goaway_text() const {
  return goaways().empty() ? "" : goaways().front().text;
}

std::size_t RawHttp2::ResetsOf(std::uint32_t code) const {
  return static_cast<std::size_t>(
      std::count_if(streams().begin(), streams().end(),
                    [code](const auto& entry) { return entry.second.reset == code; }));
}

std::string TlsClientHello() {
  const SslContext context(SSL_CTX_new(TLS_client_method()));
  const Ssl ssl(SSL_new(context.get()));
  constexpr unsigned char kProtocols[] = {2, 'h', '2'};
  SSL_set_alpn_protos(ssl.get(), kProtocols, sizeof(kProtocols));
  BIO* out = BIO_new(BIO_s_mem());
  SSL_set_bio(ssl.get(), BIO_new(BIO_s_mem()), out);
  SSL_set_connect_state(ssl.get());
  SSL_do_handshake(ssl.get());
  ERR_clear_error();
  return Drain(out);
}

}  // namespace uplink::testing
