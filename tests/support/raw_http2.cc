#include "tests/support/raw_http2.h"

#include <algorithm>

#include <nghttp2/nghttp2.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>

#include "schema/base/check.h"

namespace uplink::testing {
namespace {

constexpr int kAlertCloseNotify = 0;
constexpr std::size_t kPlainBytes = 16 * 1024;
/// Of a stream and of the connection, until the peer says otherwise.
constexpr std::uint64_t kWindowDefault = 65'535;

struct BioFree {
  void operator()(BIO* bio) const { BIO_free(bio); }
};
struct ContextFree {
  void operator()(SSL_CTX* context) const { SSL_CTX_free(context); }
};
struct SslFree {
  void operator()(SSL* ssl) const { SSL_free(ssl); }
};
struct X509Free {
  void operator()(X509* certificate) const { X509_free(certificate); }
};
struct KeyFree {
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
};
using Certificate = std::unique_ptr<X509, X509Free>;

std::unique_ptr<BIO, BioFree> Reader(const std::string& text) {
  return std::unique_ptr<BIO, BioFree>(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

Certificate CertificateOf(const std::string& pem) {
  Certificate certificate(PEM_read_bio_X509(Reader(pem).get(), nullptr, nullptr, nullptr));
  UPLINK_CHECK(certificate != nullptr, "a certificate of the test's own");
  return certificate;
}

void UseIdentity(SSL_CTX* context, const KeyPair& identity) {
  if (identity.certificate.empty()) return;
  const std::unique_ptr<EVP_PKEY, KeyFree> key(
      PEM_read_bio_PrivateKey(Reader(identity.key).get(), nullptr, nullptr, nullptr));
  UPLINK_CHECK(SSL_CTX_use_certificate(context, CertificateOf(identity.certificate).get()) == 1 &&
                   SSL_CTX_use_PrivateKey(context, key.get()) == 1,
               "a key pair of the test's own");
}

void SawMessage(int is_sent, int /*version*/, int content_type, const void* bytes, std::size_t size,
                SSL* /*ssl*/, void* alert) {
  if (is_sent == 1 || content_type != SSL3_RT_ALERT || size < 2) return;
  const int description = static_cast<const unsigned char*>(bytes)[1];
  if (description == kAlertCloseNotify) return;
  *static_cast<std::optional<int>*>(alert) = description;
}

std::string FieldOf(const http2::Fields& fields, std::string_view name) {
  const auto found =
      std::find_if(fields.begin(), fields.end(), [name](const auto& f) { return f.first == name; });
  return found == fields.end() ? "" : found->second;
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
    X509_STORE_add_cert(SSL_CTX_get_cert_store(context.get()),
                        CertificateOf(options.server_ca).get());
    SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, nullptr);
    SSL_CTX_set_max_proto_version(context.get(), options.tls_max);
    if (!options.suites_of_12.empty()) {
      SSL_CTX_set_cipher_list(context.get(), options.suites_of_12.c_str());
    }
    UseIdentity(context.get(), options.identity);
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

  std::unique_ptr<SSL_CTX, ContextFree> context;
  std::unique_ptr<SSL, SslFree> ssl;
  /// Both are the ssl's.
  BIO* in = nullptr;
  BIO* out = nullptr;
};

struct RawHttp2::Inflater {
  Inflater() { UPLINK_CHECK(nghttp2_hd_inflate_new(&inflater) == 0, "nghttp2 has memory"); }
  ~Inflater() { nghttp2_hd_inflate_del(inflater); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  nghttp2_hd_inflater* inflater = nullptr;
};

std::string RawStream::Trailer(std::string_view name) const {
  return FieldOf(header_blocks > 1 ? trailers : headers, name);
}

std::string RawStream::Header(std::string_view name) const { return FieldOf(headers, name); }

RawHttp2::RawHttp2(const Options& options)
    : patience_(options.patience),
      tcp_(options.port, options.source),
      tls_(std::make_unique<Tls>(options)),
      inflater_(std::make_unique<Inflater>()) {
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
  const auto initial = settings_.find(http2::kInitialWindowSize);
  const std::uint64_t of_stream =
      (initial == settings_.end() ? kWindowDefault : initial->second) + At(stream).window_given;
  const auto sent = sent_.find(stream);
  return static_cast<std::size_t>(std::min(of_stream - (sent == sent_.end() ? 0 : sent->second),
                                           kWindowDefault + window_given_ - sent_in_all_));
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
    const std::string_view part = bytes.substr(done, std::min(WindowOf(stream), kFrameBytesMax));
    if (part.empty() || !Send(http2::Data(stream, part))) break;
    done += part.size();
    sent_[stream] += part.size();
    sent_in_all_ += part.size();
  }
  return done;
}

bool RawHttp2::SendPlain(std::string_view bytes) {
  out_ += bytes;
  return Flush(SystemClock{}.Steady() + std::min(kSendPatience, patience_));
}

bool RawHttp2::Begin(const std::vector<std::pair<std::uint16_t, std::uint32_t>>& settings) {
  if (!Send(http2::Preface() + http2::Settings(settings))) return false;
  if (!ReadUntil([this] { return settings_came_; }, patience_)) return false;
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
  const std::size_t before = pongs_;
  return Send(http2::Ping()) && ReadUntil([this, before] { return pongs_ > before; });
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
    in_.append(plain.data(), static_cast<std::size_t>(size));
    ReadFrames();
  }
  ERR_clear_error();
  out_ += Drain(tls_->out);
}

void RawHttp2::ReadFrames() {
  std::string_view rest = in_;
  while (rest.size() >= http2::kHeadBytes) {
    const std::size_t size = http2::NumberOf(rest.substr(0, 3));
    UPLINK_CHECK(size <= kFrameBytesMax, "the server keeps the limit of frames");
    if (rest.size() < http2::kHeadBytes + size) break;
    constexpr std::uint32_t kReservedBit = 0x80000000U;
    OnFrame(static_cast<std::uint8_t>(rest[3]), static_cast<std::uint8_t>(rest[4]),
            http2::NumberOf(rest.substr(5, 4)) & ~kReservedBit,
            rest.substr(http2::kHeadBytes, size));
    rest.remove_prefix(http2::kHeadBytes + size);
  }
  in_.erase(0, in_.size() - rest.size());
}

void RawHttp2::OnFrame(std::uint8_t type, std::uint8_t flags, std::uint32_t id,
                       std::string_view payload) {
  if (id == 0) {
    const bool is_ack = (flags & http2::kAck) != 0;
    if (type == http2::kSettings && !is_ack) OnSettings(payload);
    if (type == http2::kPing && is_ack) ++pongs_;
    if (type == http2::kGoaway) OnGoaway(payload);
    if (type == http2::kWindowUpdate) window_given_ += http2::NumberOf(payload);
    return;
  }
  if (streams_.size() >= kStreamsKeptMax && !streams_.contains(id)) return;
  RawStream& stream = streams_[id];
  if (type == http2::kRstStream) stream.reset = http2::NumberOf(payload);
  if (type == http2::kWindowUpdate) stream.window_given += http2::NumberOf(payload);
  if (type == http2::kData) {
    ++stream.data_frames;
    stream.data += payload.substr(0, kDataKeptMax - stream.data.size());
  }
  if (type == http2::kHeaders || type == http2::kContinuation) {
    header_block_ += payload;
    if ((flags & http2::kEndHeaders) != 0) OnHeaderBlock(stream, std::exchange(header_block_, {}));
  }
  if (type <= http2::kHeaders && (flags & http2::kEndStream) != 0) stream.ended = true;
}

void RawHttp2::OnHeaderBlock(RawStream& stream, std::string_view block) {
  http2::Fields& fields = stream.header_blocks++ == 0 ? stream.headers : stream.trailers;
  const auto* at = reinterpret_cast<const std::uint8_t*>(block.data());
  std::size_t left = block.size();
  for (;;) {
    nghttp2_nv field{};
    int flags = 0;
    const ssize_t taken = nghttp2_hd_inflate_hd2(inflater_->inflater, &field, &flags, at, left, 1);
    UPLINK_CHECK(taken >= 0, "the server's HPACK is sound");
    at += taken;
    left -= static_cast<std::size_t>(taken);
    if ((flags & NGHTTP2_HD_INFLATE_EMIT) != 0) {
      fields.emplace_back(std::string(reinterpret_cast<const char*>(field.name), field.namelen),
                          std::string(reinterpret_cast<const char*>(field.value), field.valuelen));
    }
    if ((flags & NGHTTP2_HD_INFLATE_FINAL) != 0) break;
  }
  nghttp2_hd_inflate_end_headers(inflater_->inflater);
}

void RawHttp2::OnGoaway(std::string_view payload) {
  if (payload.size() < 8 || goaways_.size() >= kGoawaysKeptMax) return;
  goaways_.push_back({.last_stream = http2::NumberOf(payload.substr(0, 4)),
                      .code = http2::NumberOf(payload.substr(4, 4)),
                      .text = std::string(payload.substr(8))});
}

void RawHttp2::OnSettings(std::string_view payload) {
  settings_came_ = true;
  for (; payload.size() >= 6; payload.remove_prefix(6)) {
    settings_[static_cast<std::uint16_t>(http2::NumberOf(payload.substr(0, 2)))] =
        http2::NumberOf(payload.substr(2, 4));
  }
}

const RawStream& RawHttp2::At(std::uint32_t stream) const {
  static const RawStream kNothing;
  const auto found = streams_.find(stream);
  return found == streams_.end() ? kNothing : found->second;
}

std::optional<std::uint32_t> RawHttp2::goaway_code() const {
  if (goaways_.empty()) return std::nullopt;
  return goaways_.front().code;
}

std::string RawHttp2::goaway_text() const { return goaways_.empty() ? "" : goaways_.front().text; }

std::size_t RawHttp2::ResetsOf(std::uint32_t code) const {
  return static_cast<std::size_t>(
      std::count_if(streams_.begin(), streams_.end(),
                    [code](const auto& entry) { return entry.second.reset == code; }));
}

std::string TlsClientHello() {
  const std::unique_ptr<SSL_CTX, ContextFree> context(SSL_CTX_new(TLS_client_method()));
  const std::unique_ptr<SSL, SslFree> ssl(SSL_new(context.get()));
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
