#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/front/http2/frame_heads.h"
#include "server/front/http2/frame_rates.h"
#include "server/front/http2/http2_memory.h"
#include "server/front/http2/limits.h"

struct nghttp2_session;
struct nghttp2_session_callbacks;
struct nghttp2_option;

namespace uplink::front {

/// Header fields that we send, in order.
using Headers = std::vector<std::pair<std::string_view, std::string>>;

/// The text to a peer whose connection ends for Http2::flooded().
inline constexpr std::string_view kFloodedText = "too many frames that ask for an answer";

/// One HTTP/2 stream that a peer opened. The calls come while bytes are received or sent, so none
/// may destroy the stream.
class Http2Stream {
 public:
  virtual ~Http2Stream() = default;
  /// False: ignore the rest of the headers.
  virtual bool OnHeader(std::string_view name, std::string_view value) = 0;
  /// The request's headers are whole.
  virtual void OnHeadersEnd() = 0;
  virtual void OnData(std::string_view bytes) = 0;
  /// The peer sends nothing more.
  virtual void OnEnd() = 0;
  /// The peer gives the stream up, with an HTTP/2 code; OnClosed follows.
  virtual void OnReset(std::uint32_t code) = 0;
  /// The stream is gone; no call follows.
  virtual void OnClosed() = 0;

  /// What a body gives to be sent.
  struct Body {
    enum class State : std::uint8_t {
      kMore,
      /// Nothing now, until Http2::Resume.
      kWait,
      /// These are the last bytes; OnBodyEnd submits the trailers.
      kEnd,
    };
    State state = State::kWait;
    std::size_t bytes = 0;
  };
  /// Writes up to `size` bytes of the response's body.
  virtual Body OnBody(char* into, std::size_t size) = 0;
  /// The last bytes of the body go out: submit the trailers now.
  virtual void OnBodyEnd() = 0;
};

/// Events of a connection beside its streams'.
class Http2Peer {
 public:
  virtual ~Http2Peer() = default;
  /// The peer opens a stream; null refuses it.
  virtual Http2Stream* OnStream(std::int32_t id) = 0;
  /// A frame that costs us more than its sender begins to arrive, or has arrived.
  virtual void OnFrame(FrameKind kind) = 0;
  /// A header list is past kHeaderBombBytes: the rest of it is ignored.
  virtual void OnHeaderBomb() = 0;
  /// The peer has answered every PING of ours.
  virtual void OnPong() = 0;
  /// We sent HEADERS or DATA.
  virtual void OnSent() = 0;
  /// The peer broke a rule on one stream, which ends by our RST_STREAM with this code's name.
  virtual void OnStreamFault(std::string_view code) = 0;
  /// We sent a GOAWAY with an error: the session ends because the peer broke a rule, or by End.
  virtual void OnFault() = 0;
};

/// The callbacks and options that all sessions of a thread share.
class Http2Rules final {
 public:
  Http2Rules();
  ~Http2Rules();
  Http2Rules(const Http2Rules&) = delete;
  Http2Rules& operator=(const Http2Rules&) = delete;

  [[nodiscard]] const nghttp2_session_callbacks* callbacks() const { return callbacks_; }
  [[nodiscard]] const nghttp2_option* options() const { return options_; }

 private:
  nghttp2_session_callbacks* callbacks_ = nullptr;
  nghttp2_option* options_ = nullptr;
};

/// The server's side of one HTTP/2 connection, without its socket; wraps nghttp2. Only
/// ConsumeStream opens a stream's window; the connection's opens as bytes arrive.
///
/// Thread: confined to its connection's.
class Http2 final {
 public:
  /// The peer may open so many streams at once.
  Http2(const Http2Rules& rules, Http2Memory& memory, Http2Peer& peer, std::uint32_t streams_max);
  ~Http2();
  Http2(const Http2&) = delete;
  Http2& operator=(const Http2&) = delete;

  /// Processes what arrived; false if the peer broke the rules. The frames that are still to be
  /// sent say so, and then the connection ends.
  [[nodiscard]] bool Receive(std::string_view bytes);
  /// Fills `into` with frames to send, until it has `bytes` or no more are ready; the last one may
  /// exceed that.
  void Gather(std::string& into, std::size_t bytes);
  /// Neither side has anything left to send.
  [[nodiscard]] bool over() const;

  /// Sends the response's headers. With kBody the stream's body follows, otherwise the response
  /// ends.
  enum class Then : std::uint8_t { kBody, kEnd };
  void Respond(std::int32_t stream, const Headers& headers, Then then);
  /// The body has bytes again.
  void Resume(std::int32_t stream);
  void Trailers(std::int32_t stream, const Headers& headers);
  void Reset(std::int32_t stream, std::uint32_t code);
  void ConsumeStream(std::int32_t stream, std::size_t bytes);

  void Ping();
  /// As Ping, unless one has no answer yet.
  void PingOnce() {
    if (pings_open_ == 0) Ping();
  }
  /// Tells the peer to open no more streams here; those that it opens meanwhile still count.
  void NoticeEnd();
  /// Ends the connection and its streams with a code, and a text for people who debug.
  void End(std::uint32_t code, std::string_view text);

  /// More than kAnswersWaitingMax answers to the peer's PING and SETTINGS wait to be sent.
  [[nodiscard]] bool flooded() const { return answers_waiting_ > kAnswersWaitingMax; }

  /// Only nghttp2's callbacks call this and what follows.
  [[nodiscard]] Http2Peer& peer() { return peer_; }
  [[nodiscard]] nghttp2_session* session() { return session_; }
  /// A header list begins; CountHeader adds a field of so many bytes, and returns false if the list
  /// is a bomb.
  void BeginHeaders() { header_bytes_ = 0; }
  [[nodiscard]] bool CountHeader(std::size_t bytes);
  /// A PING or SETTINGS came that must be answered.
  void OnQuestion() { ++answers_waiting_; }
  /// The answer to one of these went out.
  void OnAnswerSent() {
    if (answers_waiting_ > 0) --answers_waiting_;
  }
  /// An answer to a PING has come; false if none of ours was open.
  [[nodiscard]] bool TakePong();
  [[nodiscard]] bool waits_for_pong() const { return pings_open_ > 0; }
  /// The peer ended this stream, or reset it.
  void NoteEnd(std::int32_t stream) { frame_heads_.NoteEnd(stream); }

 private:
  Http2Peer& peer_;
  nghttp2_session* session_ = nullptr;
  FrameHeads frame_heads_;
  std::size_t answers_waiting_ = 0;
  /// Bytes of the header list that arrives.
  std::size_t header_bytes_ = 0;
  /// PINGs without an answer.
  std::size_t pings_open_ = 0;
};

}  // namespace uplink::front
