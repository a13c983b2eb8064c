#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/http2_frames.h"

namespace uplink::testing {

/// What a peer answered on one stream. A value.
struct RawStream {
  /// Of the first block of headers, and of the second.
  http2::Fields headers;
  http2::Fields trailers;
  std::size_t header_blocks = 0;
  /// Up to Http2Answers::kDataKeptMax bytes.
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

/// What a peer says on one HTTP/2 connection, out of its bytes. A peer that breaks HTTP/2's rules
/// ends the test program: it is the server under test.
///
/// Limits: what it keeps, by the constants below.
/// Thread: confined to one.
class Http2Answers final {
 public:
  static constexpr std::size_t kDataKeptMax = std::size_t{4} * 1024 * 1024;
  static constexpr std::size_t kStreamsKeptMax = 20'000;
  static constexpr std::size_t kGoawaysKeptMax = 100;
  /// Larger frames are not allowed to the peer.
  static constexpr std::size_t kFrameBytesMax = std::size_t{16} * 1024;

  struct Goaway {
    std::uint32_t last_stream = 0;
    std::uint32_t code = 0;
    std::string text;
  };

  Http2Answers();
  ~Http2Answers();
  Http2Answers(const Http2Answers&) = delete;
  Http2Answers& operator=(const Http2Answers&) = delete;

  /// The next bytes, cut anywhere.
  void Add(std::string_view bytes);

  /// Nothing of an unknown stream is known.
  [[nodiscard]] const RawStream& At(std::uint32_t stream) const;
  /// Streams that the peer said anything about.
  [[nodiscard]] const std::map<std::uint32_t, RawStream>& streams() const { return streams_; }
  [[nodiscard]] const std::vector<Goaway>& goaways() const { return goaways_; }
  [[nodiscard]] const std::map<std::uint16_t, std::uint32_t>& settings() const { return settings_; }
  [[nodiscard]] bool settings_came() const { return settings_came_; }
  /// Bytes that WINDOW_UPDATEs gave the connection.
  [[nodiscard]] std::uint64_t window_given() const { return window_given_; }
  [[nodiscard]] std::size_t pongs() const { return pongs_; }
  /// PINGs of the peer's own.
  [[nodiscard]] std::size_t pings() const { return pings_; }

 private:
  struct Inflater;

  void OnFrame(std::uint8_t type, std::uint8_t flags, std::uint32_t stream,
               std::string_view payload);
  void OnHeaderBlock(RawStream& stream, std::string_view block);
  void OnGoaway(std::string_view payload);
  void OnSettings(std::string_view payload);

  std::unique_ptr<Inflater> inflater_;
  /// Of a frame that is not whole.
  std::string in_;
  std::map<std::uint32_t, RawStream> streams_;
  /// The headers that have begun, of this stream.
  std::string header_block_;
  std::vector<Goaway> goaways_;
  std::map<std::uint16_t, std::uint32_t> settings_;
  bool settings_came_ = false;
  std::uint64_t window_given_ = 0;
  std::size_t pongs_ = 0;
  std::size_t pings_ = 0;
};

}  // namespace uplink::testing
