#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <openssl/bio.h>
#include <openssl/types.h>

#include "server/front/tls/client_offer.h"
#include "server/front/tls/hello_size.h"
#include "server/front/tls/tls_context.h"
#include "server/front/tls/tls_peer.h"
#include "server/identity/certificate_gate.h"
#include "server/identity/certificate_messages.h"
#include "server/identity/deny_list.h"
#include "server/transport/turned_away.h"

namespace uplink::front {

/// Bytes of the largest TLS record's content.
inline constexpr std::size_t kRecordBytes = 16 * 1024;

/// Bytes of a peer's first message. Agents send some hundred, 1.7 KiB with a key share of ML-KEM.
/// OpenSSL takes 3.3 ms for 16 KiB of key shares (measured).
inline constexpr std::size_t kClientHelloBytesMax = 4 * 1024;

/// Bytes of a peer's side of a handshake: two ClientHellos, its certificates, a signature, and the
/// heads of their records. OpenSSL gets no more. A record of one byte costs it 0.7 us.
inline constexpr std::size_t kHandshakeBytesMax = 48 * 1024;
static_assert(kHandshakeBytesMax > 2 * kClientHelloBytesMax + identity::kShownBytesMax);
/// How often a handshake may go on because bytes came: 32 KiB of certificates are 61 of the
/// smallest usual segments, and one byte at a time costs 17 us each.
inline constexpr std::size_t kHandshakeReadsMax = 128;

/// Buffers through which the connections of a thread encrypt and decrypt, one after the other.
struct TlsBuffers {
  /// Ciphertext that has arrived and is not processed.
  std::string_view in;
  /// Ciphertext to send.
  std::string out;
  std::array<char, kRecordBytes> plain;
  /// What the ClientHello of this handshake step offered.
  ClientOffer offer;
};

/// Connects OpenSSL to TlsBuffers; one for all engines of a thread, and their context.
class BufferMethod final {
 public:
  BufferMethod();
  ~BufferMethod();
  BufferMethod(const BufferMethod&) = delete;
  BufferMethod& operator=(const BufferMethod&) = delete;
  [[nodiscard]] BIO_METHOD* get() const { return method_; }

 private:
  BIO_METHOD* const method_;
};

/// The TLS of one connection, without its socket: bytes in, bytes out, by the thread's buffers.
///
/// Thread: confined to that of the buffers.
class TlsEngine final {
 public:
  enum class Step : std::uint8_t {
    /// Waits for more bytes.
    kMore,
    kDone,
    /// An alert may wait in `out`.
    kFailed,
  };
  enum class Failure : std::uint8_t {
    kNone,
    /// The peer does not speak TLS.
    kNoTls,
    /// The peer offers no version, suite or protocol that we accept.
    kNothingShared,
    kNoCertificate,
    /// No authority of ours signed its certificate.
    kUntrusted,
    /// Its certificates are not examined (certificate_flaw).
    kCertificate,
    kOther,
  };

  TlsEngine(std::shared_ptr<const TlsContext> context, const BufferMethod& method,
            TlsBuffers& buffers);
  ~TlsEngine();
  TlsEngine(const TlsEngine&) = delete;
  TlsEngine& operator=(const TlsEngine&) = delete;

  /// Goes on with the handshake with the bytes in `in`.
  ///
  /// Limits: kHandshakeReadsMax, kHandshakeBytesMax; past them it fails (Failure::kOther).
  [[nodiscard]] Step Handshake();
  /// A byte of the peer has come: it does more than check whether we answer.
  [[nodiscard]] bool begun() const { return begun_; }
  /// Why it failed.
  [[nodiscard]] Failure failure() const { return failure_; }
  /// The detail that the log adds to the failure: what is wrong with the certificates, which bound
  /// was exceeded, or what the two do not agree on. Empty for other failures, and without one.
  [[nodiscard]] std::string_view detail() const { return detail_; }
  /// What is wrong with its certificates; with Failure::kCertificate.
  [[nodiscard]] identity::CertificateFlaw certificate_flaw() const { return messages_.flaw(); }
  /// The peer; after the handshake.
  [[nodiscard]] TlsPeer Peer() const {
    return PeerOf(ssl_, verify_error_, context_->trusted().rules());
  }
  /// Whether the peer, which came in, may stay by what is served now.
  [[nodiscard]] absl::Status JudgeAgain(const TlsContext& now,
                                        const identity::PeerIdentity& peer) const {
    if (&now == context_.get()) return absl::OkStatus();
    return now.trusted().JudgeAgain(peer, ssl_, context_->trusted().rules());
  }
  /// Whether the list names what the peer has shown; after the handshake.
  [[nodiscard]] bool IsDenied(const identity::DeniedCertificates& list, const TlsPeer& peer) const {
    return identity::Denies(list, ssl_, peer.certificate);
  }

  /// The next piece of the peer's data. An empty piece stands for a TLS handshake message after the
  /// handshake, mostly new keys. Empty optional if more bytes are needed, or the peer ended.
  [[nodiscard]] std::optional<std::string_view> Read();
  /// The peer ended its side, or broke the rules.
  [[nodiscard]] bool over() const { return over_; }
  /// Encrypts into `out`; false if the connection is broken.
  [[nodiscard]] bool Write(std::string_view plain);
  /// Ends our side.
  void WriteEnd();

  /// OpenSSL asks for our verdict on a certificate of a peer's chain.
  static int OnVerified(int good, X509_STORE_CTX* store);
  /// OpenSSL reports a ClientHello before it reads it.
  static int OnClientHello(SSL* connection, int* alert, void* argument);

 private:
  /// One step of OpenSSL's handshake with the bytes in `in`: SSL_do_handshake's result.
  [[nodiscard]] int Advance();
  [[nodiscard]] Step Fail(Failure failure, std::string detail = {});
  [[nodiscard]] Step FailToAgree(Agreed what);
  /// Fails for the reason in OpenSSL's error queue.
  [[nodiscard]] Step FailByOpenSsl();
  /// An empty piece for a message that came after the handshake; empty optional if there is none.
  [[nodiscard]] std::optional<std::string_view> TakeLate();

  const std::shared_ptr<const TlsContext> context_;
  TlsBuffers& buffers_;
  SSL* const ssl_;
  identity::CertificateMessages messages_;
  Failure failure_ = Failure::kNone;
  std::string detail_;
  /// The first flaw of a trusted chain: X509_V_ERR_..., X509_V_OK for none.
  int verify_error_ = 0;
  bool begun_ = false;
  HelloSize hello_;
  std::size_t handshake_reads_ = 0;
  std::size_t handshake_bytes_ = 0;
  bool over_ = false;
  /// Handshake messages that came after the handshake, and that Read has not reported.
  std::uint32_t late_messages_ = 0;
};

/// What a handshake that failed counts as.
[[nodiscard]] transport::TurnedAway CauseOf(TlsEngine::Failure failure);

}  // namespace uplink::front
