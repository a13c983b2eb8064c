#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "tests/support/certificates.h"
#include "tests/support/shown_chain.h"

namespace uplink::testing {

/// A client of TLS without a socket: bytes in, bytes out. It does not verify the server.
/// Confined to one thread.
class MemoryTls final {
 public:
  struct Options {
    /// What it shows; empty: nothing.
    KeyPair identity;
    /// What it shows behind that.
    std::shared_ptr<const ShownChain> behind;
    /// OpenSSL's number of the highest version of TLS; 0: what the library has.
    int version_max = 0;
    /// OpenSSL's names of its groups, with colons in between; empty: those of the library.
    std::string groups;
    /// The same of its signature algorithms, and of its suites of TLS 1.2.
    std::string signatures;
    std::string suites_of_12;
    /// What it offers by ALPN, each name behind its length; empty: nothing.
    std::string protocols = "\2h2";
    /// The content of each record of TLS 1.3 is padded to a multiple of so many bytes; 0: it is
    /// not.
    std::size_t padded_bytes = 0;
    /// It shows its certificate also if it is asked for it after the handshake (TLS 1.3).
    bool shows_later = false;
  };

  explicit MemoryTls(const Options& options);
  ~MemoryTls();
  MemoryTls(const MemoryTls&) = delete;
  MemoryTls& operator=(const MemoryTls&) = delete;

  // What the client says once the handshake is over: the bytes.
  [[nodiscard]] std::string Say(std::string_view plain);
  /// It goes on with new keys (TLS 1.3).
  [[nodiscard]] std::string RenewKeys();
  /// It asks for a second handshake (TLS 1.2).
  [[nodiscard]] std::string Renegotiate();

  /// Goes on by what the server says; what the client says to that.
  [[nodiscard]] std::string Step(std::string_view from_server);
  /// The handshake is over on this side.
  [[nodiscard]] bool done() const { return done_; }
  /// The description of the server's alert.
  [[nodiscard]] std::optional<int> alert() const { return alert_; }

 private:
  struct Tls;

  [[nodiscard]] std::string TakeSaid();

  std::unique_ptr<Tls> tls_;
  bool done_ = false;
  std::optional<int> alert_;
};

}  // namespace uplink::testing
