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
#include "tests/support/http2_frames.h"
#include "tests/support/raw_tcp.h"

namespace uplink::testing {

/// What a peer answered on one stream. A value.
struct RawStream {
  /// Of the first block of headers, and of the second.
  http2::Fields headers;
  http2::Fields trailers;
  std::size_t header_blocks = 0;
  /// Up to RawHttp2::kDataKeptMax bytes.
  std::string data;
  std::size_t data_frames = 0;
  /// The peer has sent its last.
  bool ended = false;
  /// The code of its RST_STREAM.
  std::optional<std::uint32_t> reset;
  /// Bytes that its WINDOW_UPDATEs gave us to send.
  std::uint64_t window_given = 0;

  /// The response is over, one way or the other.
  [[nodiscard]] bool over() const { return ended || reset.has_value(); }
  /// Of the trailers, or of headers that are all there is; empty if there is none.
  [[nodiscard]] std::string Trailer(std::string_view name) const;
  [[nodiscard]] std::string Header(std::string_view name) const;
};

/// One HTTP/2 connection of a client that says what it is told, right or wrong, over TLS on
/// loopback.
///
/// Limits: what it keeps of what the peer says, by the constants below; every wait by its patience.
/// Thread: confined to one.
class RawHttp2 final {
 public:
  static constexpr std::size_t kDataKeptMax = std::size_t{4} * 1024 * 1024;
  static constexpr std::size_t kStreamsKeptMax = 20'000;
  static constexpr std::size_t kGoawaysKeptMax = 100;
  /// Larger frames are not allowed to the peer.
  static constexpr std::size_t kFrameBytesMax = std::size_t{16} * 1024;
  /// How long a peer may take nothing of what is sent.
  static constexpr std::chrono::milliseconds kSendPatience{10'000};

  struct Options {
    std::uint16_t port = 0;
    /// The authority that the server's certificate must come from.
    std::string server_ca;
    /// What the client shows; empty: nothing.
    KeyPair identity;
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
  struct Goaway {
    std::uint32_t last_stream = 0;
    std::uint32_t code = 0;
    std::string text;
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
  /// DATA of the stream, as far as the peer's windows allow: waits up to `patience` for them to
  /// open. Says how many bytes went out.
  std::size_t SendData(std::uint32_t stream, std::string_view bytes,
                       std::chrono::milliseconds patience = kPatience);
  /// Bytes that the stream may send now, by what the peer has given it and what SendData has taken.
  [[nodiscard]] std::size_t WindowOf(std::uint32_t stream) const;
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
  [[nodiscard]] const RawStream& At(std::uint32_t stream) const;
  /// Streams that the peer said anything about.
  [[nodiscard]] const std::map<std::uint32_t, RawStream>& streams() const { return streams_; }
  [[nodiscard]] const std::vector<Goaway>& goaways() const { return goaways_; }
  /// The first one's code, and text; nothing if there is none.
  [[nodiscard]] std::optional<std::uint32_t> goaway_code() const;
  [[nodiscard]] std::string goaway_text() const;
  [[nodiscard]] const std::map<std::uint16_t, std::uint32_t>& settings() const { return settings_; }
  /// Bytes that WINDOW_UPDATEs gave the connection.
  [[nodiscard]] std::uint64_t window_given() const { return window_given_; }
  [[nodiscard]] std::size_t pongs() const { return pongs_; }
  /// Streams of the server's RST_STREAM with this code.
  [[nodiscard]] std::size_t ResetsOf(std::uint32_t code) const;

 private:
  struct Tls;
  struct Inflater;

  void Handshake(SteadyTime deadline);
  bool Flush(SteadyTime deadline);
  void ReceiveOnce();
  void Decrypt();
  void ReadFrames();
  void OnFrame(std::uint8_t type, std::uint8_t flags, std::uint32_t stream,
               std::string_view payload);
  void OnHeaderBlock(RawStream& stream, std::string_view block);
  void OnGoaway(std::string_view payload);
  void OnSettings(std::string_view payload);

  const std::chrono::milliseconds patience_;
  RawTcp tcp_;
  std::unique_ptr<Tls> tls_;
  std::unique_ptr<Inflater> inflater_;
  bool handshaken_ = false;
  std::optional<int> alert_;
  /// Ciphertext that the system has not taken; plaintext of a frame that is not whole.
  std::string out_;
  std::string in_;
  std::map<std::uint32_t, RawStream> streams_;
  /// The headers that have begun, of this stream.
  std::string header_block_;
  /// Bytes of SendData.
  std::map<std::uint32_t, std::uint64_t> sent_;
  std::uint64_t sent_in_all_ = 0;
  std::vector<Goaway> goaways_;
  std::map<std::uint16_t, std::uint32_t> settings_;
  bool settings_came_ = false;
  std::uint64_t window_given_ = 0;
  std::size_t pongs_ = 0;
};

/// What a TLS client says first; the same bytes may begin many connections.
[[nodiscard]] std::string TlsClientHello();

}  // namespace uplink::testing
