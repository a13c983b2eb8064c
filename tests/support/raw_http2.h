#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/certificates.h"
#include "tests/support/eventually.h"
#include "tests/support/http2_answers.h"
#include "tests/support/http2_frames.h"
#include "tests/support/raw_tcp.h"
#include "tests/support/shown_chain.h"

namespace uplink::testing {

/// One HTTP/2 connection of a client that says what it is told, right or wrong, over TLS on
/// loopback.
///
/// Limits: what it keeps of what the peer says, as Http2Answers does; every wait by its patience.
/// Thread: confined to one.
class RawHttp2 final {
 public:
  /// How long a peer may take nothing of what is sent.
  static constexpr std::chrono::milliseconds kSendPatience{10'000};

  struct Options {
    std::uint16_t port = 0;
    /// The authority that the server's certificate must come from.
    std::string server_ca;
    /// What the client shows, with those that stand between it and an authority behind its
    /// certificate; empty: nothing.
    KeyPair identity;
    /// Shown behind that; null: nothing.
    std::shared_ptr<const ShownChain> behind{};
    /// The address to come from; empty: any.
    std::string source;
    /// Offered by ALPN; empty: the extension is missing.
    std::vector<std::string> protocols{"h2"};
    /// OpenSSL's number of the highest version of TLS; 0: what the library has.
    int tls_max = 0;
    /// OpenSSL's names of the suites of TLS 1.2 that are offered; empty: those of the library.
    std::string suites_of_12;
    /// Called once the connection is there.
    std::function<void(RawTcp& connection)> at_first;
    /// Bytes that go out in one piece with what TLS says first.
    std::string before_tls;
    /// How long the handshake and the peer's SETTINGS may take, and, below kSendPatience, how long
    /// the peer may take nothing.
    std::chrono::milliseconds patience = kPatience;
  };

  /// Connects and does the handshake; open() says whether that went well.
  explicit RawHttp2(const Options& options);
  ~RawHttp2();
  RawHttp2(const RawHttp2&) = delete;
  RawHttp2& operator=(const RawHttp2&) = delete;

  // --- To the peer ---

  /// False once the connection has ended, or if the peer takes nothing for the patience. What
  /// arrives meanwhile is read.
  bool Send(std::string_view bytes);
  /// DATA of the stream, within the peer's windows: waits up to `patience` for them to open. Says
  /// how many bytes went out.
  std::size_t SendData(std::uint32_t stream, std::string_view bytes,
                       std::chrono::milliseconds patience = kPatience);
  /// Bytes that the stream may send now, by what the peer has given it and what SendData has taken.
  [[nodiscard]] std::size_t WindowOf(std::uint32_t stream) const;
  /// New keys of TLS 1.3, so many times. False as for Send.
  bool UpdateKeys(std::size_t times);
  /// Says that TLS ends here (close_notify). False as for Send.
  bool EndTls();
  /// Without TLS, into the connection as it is.
  bool SendPlain(std::string_view bytes);
  /// Preface and SETTINGS, and the acknowledgement of the peer's; false if those do not come.
  bool Begin(const std::vector<std::pair<std::uint16_t, std::uint32_t>>& settings = {});

  // --- From the peer ---

  /// Reads until the condition holds; false if it does not within `patience`, or can no more since
  /// the connection has ended.
  [[nodiscard]] bool ReadUntil(const std::function<bool()>& condition,
                               std::chrono::milliseconds patience = kPatience);
  [[nodiscard]] bool ReadUntilOver(std::uint32_t stream) {
    return ReadUntil([this, stream] { return At(stream).over(); });
  }
  [[nodiscard]] bool ReadUntilEnd(std::chrono::milliseconds patience = kPatience);
  /// Sends a PING and reads until it is answered: all that was sent before has been processed.
  [[nodiscard]] bool Sync();

  /// The handshake is done on this side, and the peer has not ended.
  [[nodiscard]] bool open() const { return handshaken_ && end() == RawTcp::End::kNone; }
  [[nodiscard]] bool handshaken() const { return handshaken_; }
  [[nodiscard]] RawTcp::End end() const { return tcp_.end(); }
  /// The description of the peer's TLS alert, but its close_notify.
  [[nodiscard]] std::optional<int> alert() const { return alert_; }
  /// The protocol that was agreed on by ALPN.
  [[nodiscard]] std::string protocol() const;

  /// Nothing of an unknown stream is known.
  [[nodiscard]] const RawStream& At(std::uint32_t stream) const { return answers_.At(stream); }
  /// Streams that the peer said anything about.
  [[nodiscard]] const std::map<std::uint32_t, RawStream>& streams() const {
    return answers_.streams();
  }
  [[nodiscard]] const std::vector<Http2Answers::Goaway>& goaways() const {
    return answers_.goaways();
  }
  /// The first one's code, and text; nothing if there is none.
  [[nodiscard]] std::optional<std::uint32_t> goaway_code() const;
  [[nodiscard]] std::string goaway_text() const;
  [[nodiscard]] const std::map<std::uint16_t, std::uint32_t>& settings() const {
    return answers_.settings();
  }
  /// Bytes that WINDOW_UPDATEs gave the connection.
  [[nodiscard]] std::uint64_t window_given() const { return answers_.window_given(); }
  [[nodiscard]] std::size_t pongs() const { return answers_.pongs(); }
  /// PINGs of the server's own, which are answered only by Send(http2::Pong()).
  [[nodiscard]] std::size_t pings() const { return answers_.pings(); }
  /// Streams of the server's RST_STREAM with this code.
  [[nodiscard]] std::size_t ResetsOf(std::uint32_t code) const;

 private:
  struct Tls;

  void Handshake(SteadyTime deadline);
  bool Flush(SteadyTime deadline);
  void ReceiveOnce();
  void Decrypt();

  const std::chrono::milliseconds patience_;
  RawTcp tcp_;
  std::unique_ptr<Tls> tls_;
  bool handshaken_ = false;
  std::optional<int> alert_;
  /// Ciphertext that the system has not taken.
  std::string out_;
  Http2Answers answers_;
  /// Bytes of SendData.
  std::map<std::uint32_t, std::uint64_t> sent_;
  std::uint64_t sent_in_all_ = 0;
};

/// What a TLS client says first; the same bytes may begin many connections.
[[nodiscard]] std::string TlsClientHello();

}  // namespace uplink::testing
