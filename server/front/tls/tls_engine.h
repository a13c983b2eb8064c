#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <openssl/bio.h>
#include <openssl/types.h>

#include "server/front/tls/client_offer.h"
#include "server/front/tls/hello_size.h"
#include "server/front/tls/tls_context.h"
#include "server/front/tls/tls_peer.h"
#include "server/identity/certificate_gate.h"
#include "server/identity/certificate_messages.h"
#include "server/transport/turned_away.h"

namespace uplink::front {

/// Bytes of the largest TLS record's content.
inline constexpr std::size_t kRecordBytes = 16 * 1024;

/// Bytes of a peer's first message. Agents say some hundred, 1.7 KiB with a key share of ML-KEM; to
/// go through 16 KiB of key shares takes OpenSSL 3.3 ms (measured).
inline constexpr std::size_t kClientHelloBytesMax = 4 * 1024;

/// Bytes of a peer's side of a handshake: two ClientHellos, its certificates, a signature, and the
/// heads of their records. OpenSSL gets none past them. A record of one byte costs it 0.7 us.
inline constexpr std::size_t kHandshakeBytesMax = 48 * 1024;
static_assert(kHandshakeBytesMax > 2 * kClientHelloBytesMax + identity::kShownBytesMax);
/// How often a handshake goes on because bytes came: 32 KiB of certificates are 61 segments of the
/// smallest usual size, and one byte at a time costs 17 us each.
inline constexpr std::size_t kHandshakeReadsMax = 128;

/// What the connections of a thread encrypt and decrypt through, one after the other.
struct TlsBuffers {
  /// Ciphertext that has arrived and was not processed.
  std::string_view in;
  /// Ciphertext that is to go out.
  std::string out;
  std::array<char, kRecordBytes> plain;
  /// Of the ClientHello that came within this step of a handshake.
  ClientOffer offer;
};

/// OpenSSL's way to TlsBuffers; one for all engines of a thread, and their context.
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
    /// It speaks no TLS.
    kNoTls,
    /// It offers no version, no suite or no protocol that we take.
    kNothingShared,
    kNoCertificate,
    /// No authority of ours signed its certificate.
    kUntrusted,
    /// It shows certificates that are not looked into (certificate_flaw).
    kCertificate,
    kOther,
  };

  TlsEngine(std::shared_ptr<const TlsContext> context, const BufferMethod& method,
            TlsBuffers& buffers);
  ~TlsEngine();
  TlsEngine(const TlsEngine&) = delete;
  TlsEngine& operator=(const TlsEngine&) = delete;

  /// Goes on with the handshake by what is in `in`.
  ///
  /// Limits: kHandshakeReadsMax, kHandshakeBytesMax; past them it fails (Failure::kOther).
  [[nodiscard]] Step Handshake();
  /// A byte of the peer's has come: who leaves now did more than look whether we answer.
  [[nodiscard]] bool begun() const { return begun_; }
  /// Why it failed.
  [[nodiscard]] Failure failure() const { return failure_; }
  /// What the log says beside the failure, of the one thing that it failed for: what is wrong with
  /// the certificates, which bound was passed, or what the two do not agree on. Empty of other
  /// failures, and as long as it has not failed.
  [[nodiscard]] std::string_view detail() const { return detail_; }
  /// What is wrong with the certificates that it shows, with Failure::kCertificate.
  [[nodiscard]] identity::CertificateFlaw certificate_flaw() const { return messages_.flaw(); }
  /// Who is there; after the handshake.
  [[nodiscard]] TlsPeer Peer() const { return PeerOf(ssl_, verify_error_); }

  /// The next piece of what the peer said; an empty one stands for a message of the handshake's
  /// kind that came after it: new keys, mostly. Nothing if more bytes are needed, or it is over.
  [[nodiscard]] std::optional<std::string_view> Read();
  /// The peer said that nothing follows, or broke the rules.
  [[nodiscard]] bool over() const { return over_; }
  /// Encrypts into `out`; false if the connection is broken.
  [[nodiscard]] bool Write(std::string_view plain);
  /// Says that nothing follows.
  void WriteEnd();

  /// OpenSSL asks what we think of a certificate of a peer's chain.
  static int OnVerified(int good, X509_STORE_CTX* store);
  /// OpenSSL tells of a ClientHello before it reads it.
  static int OnClientHello(SSL* connection, int* alert, void* argument);

 private:
  /// One step of OpenSSL's handshake by what is in `in`: SSL_do_handshake's result.
  [[nodiscard]] int Advance();
  [[nodiscard]] Step Fail(Failure failure, std::string detail = {});
  [[nodiscard]] Step FailToAgree(Agreed what);
  /// By what OpenSSL's queue of errors holds.
  [[nodiscard]] Step FailByOpenSsl();
  /// An empty piece for a message that came after the handshake; nothing if there is none.
  [[nodiscard]] std::optional<std::string_view> TakeLate();

  const std::shared_ptr<const TlsContext> context_;
  TlsBuffers& buffers_;
  SSL* const ssl_;
  identity::CertificateMessages messages_;
  Failure failure_ = Failure::kNone;
  std::string detail_;
  /// What a trusted chain lacks, the first that was found: X509_V_ERR_..., X509_V_OK for nothing.
  int verify_error_ = 0;
  bool begun_ = false;
  HelloSize hello_;
  std::size_t handshake_reads_ = 0;
  std::size_t handshake_bytes_ = 0;
  bool over_ = false;
  /// Messages of the handshake's kind that came after it, and that Read has not told of.
  std::uint32_t late_messages_ = 0;
};

/// What a handshake that failed counts as.
[[nodiscard]] transport::TurnedAway CauseOf(TlsEngine::Failure failure);

}  // namespace uplink::front
