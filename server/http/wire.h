#pragma once

#include <cstddef>
#include <optional>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <openssl/ssl.h>

#include "schema/base/check.h"
#include "server/identity/certificate_gate.h"
#include "server/identity/certificate_messages.h"

namespace uplink::http {

/// Bytes of a peer's first message of TLS, and of its whole side of a handshake: two such messages,
/// its certificates, a signature, and the heads of their records. Past them the handshake fails.
inline constexpr std::size_t kFirstMessageBytesMax = std::size_t{4} * 1024;
inline constexpr std::size_t kHandshakeBytesMax = std::size_t{48} * 1024;
static_assert(kHandshakeBytesMax > 2 * kFirstMessageBytesMax + identity::kShownBytesMax);

/// The byte that a record of a TLS handshake begins with, and no request of HTTP.
///
/// Source: RFC 8446, 5.1.
inline constexpr unsigned char kTlsHandshake = 0x16;

/// TCP, or a Unix socket, with deadlines.
using RawStream = boost::beast::basic_stream<boost::asio::generic::stream_protocol>;

/// A raw stream under TLS. Bounds the bytes of the handshake: what comes before our first answer is
/// the first message.
class BoundedStream final {
 public:
  using lowest_layer_type = RawStream::socket_type;
  using executor_type = RawStream::executor_type;

  explicit BoundedStream(RawStream& raw) : raw_(raw) {}

  [[nodiscard]] executor_type get_executor() { return raw_.get_executor(); }
  [[nodiscard]] lowest_layer_type& lowest_layer() { return raw_.socket(); }
  [[nodiscard]] const lowest_layer_type& lowest_layer() const { return raw_.socket(); }

  /// Counts bytes of the handshake that came by another way; false if there are too many.
  [[nodiscard]] bool Take(std::size_t bytes) {
    taken_ += bytes;
    return taken_ <= (answered_ ? kHandshakeBytesMax : kFirstMessageBytesMax);
  }
  /// What follows is not bounded.
  void EndHandshake() { bounded_ = false; }

  template <typename Buffers, typename Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    if (!bounded_) return raw_.async_read_some(buffers, std::forward<Handler>(handler));
    raw_.async_read_some(buffers, [this, moved = std::forward<Handler>(handler)](
                                      boost::system::error_code error, std::size_t bytes) mutable {
      if (!error && !Take(bytes)) error = boost::asio::error::message_size;
      moved(error, bytes);
    });
  }
  template <typename Buffers, typename Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    answered_ = true;
    raw_.async_write_some(buffers, std::forward<Handler>(handler));
  }

 private:
  RawStream& raw_;
  std::size_t taken_ = 0;
  bool answered_ = false;
  bool bounded_ = true;
};

/// The bytes of a connection: as they are, or by TLS. Confined to the loop's thread; outlives what
/// it was asked for.
class Wire final {
 public:
  using executor_type = RawStream::executor_type;

  explicit Wire(RawStream::socket_type socket) : raw_(std::move(socket)) {}
  Wire(const Wire&) = delete;
  Wire& operator=(const Wire&) = delete;

  [[nodiscard]] executor_type get_executor() { return raw_.get_executor(); }
  /// For deadlines and the end.
  [[nodiscard]] RawStream& raw() { return raw_; }
  [[nodiscard]] bool is_tls() const { return tls_.has_value(); }
  /// Of TLS.
  [[nodiscard]] SSL* connection() { return tls_->native_handle(); }
  /// What is wrong with the certificates that the peer showed.
  [[nodiscard]] identity::CertificateFlaw flaw() const { return certificates_->flaw(); }

  /// From now on by TLS; `first` are the bytes that came already, and stay until the handler runs.
  template <typename Handler>
  void Handshake(SSL_CTX* context, boost::asio::const_buffer first, Handler handler);
  /// Sends our end of TLS, and waits for the peer's.
  template <typename Handler>
  void EndTls(Handler handler) {
    tls_->async_shutdown(std::move(handler));
  }

  template <typename Buffers, typename Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    if (tls_) return tls_->async_read_some(buffers, std::forward<Handler>(handler));
    raw_.async_read_some(buffers, std::forward<Handler>(handler));
  }
  template <typename Buffers, typename Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    if (tls_) return tls_->async_write_some(buffers, std::forward<Handler>(handler));
    raw_.async_write_some(buffers, std::forward<Handler>(handler));
  }

 private:
  using TlsStream = boost::asio::ssl::stream<BoundedStream&>;

  RawStream raw_;
  BoundedStream bounded_{raw_};
  /// Judges certificates before OpenSSL reads them. Outlives the connection of TLS, which calls it.
  std::optional<identity::CertificateMessages> certificates_;
  std::optional<TlsStream> tls_;
};

template <typename Handler>
void Wire::Handshake(SSL_CTX* context, boost::asio::const_buffer first, Handler handler) {
  SSL* const connection = SSL_new(context);
  UPLINK_CHECK(connection != nullptr, "out of memory");
  tls_.emplace(bounded_, connection);
  certificates_.emplace(connection);
  if (!bounded_.Take(first.size())) {
    return boost::asio::post(get_executor(), [moved = std::move(handler)]() mutable {
      moved(boost::asio::error::message_size);
    });
  }
  tls_->async_handshake(boost::asio::ssl::stream_base::server, first,
                        [this, moved = std::move(handler)](boost::system::error_code error,
                                                           std::size_t /*bytes*/) mutable {
                          if (!error && certificates_->flaw() != identity::CertificateFlaw::kNone) {
                            error = boost::asio::error::no_protocol_option;
                          }
                          bounded_.EndHandshake();
                          moved(error);
                        });
}

}  // namespace uplink::http
