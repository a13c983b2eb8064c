#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// nghttp2's own name: its header stops at this folder's sources.
struct nghttp2_session;

namespace uplink::link {

/// What a stream says to its owner, from within Receive and Produce; nothing after OnClosed.
class Http2Events {
 public:
  virtual ~Http2Events() = default;
  virtual void OnHeader(std::string_view name, std::string_view value) = 0;
  virtual void OnData(std::string_view bytes) = 0;
  /// `error` is HTTP/2's code; 0 for a stream that both sides ended.
  virtual void OnClosed(std::uint32_t error) = 0;
  /// Moves up to `max` bytes of the body to `to`; `end` once nothing comes after them.
  virtual std::size_t TakeBody(std::uint8_t* to, std::size_t max, bool& end) = 0;
};

/// The client's side of one HTTP/2 connection and its streams, without a socket.
///
/// Thread: confined to one thread.
class Http2Session final {
 public:
  using Header = std::pair<std::string_view, std::string_view>;

  /// What the server may send ahead of its reader.
  struct Window {
    std::uint32_t bytes = 0;
    /// False: what was read gives no room again, as if nothing ever were.
    bool renewed = true;
    /// True: what a stream read gives it room again when Consume says so; its connection's is
    /// renewed at once, so that a stream that is not read holds up no other.
    bool by_stream = false;
  };

  explicit Http2Session(const Window& window);
  ~Http2Session();
  Http2Session(const Http2Session&) = delete;
  Http2Session& operator=(const Http2Session&) = delete;

  /// Opens a stream; its body is taken when Produce is called. Its number, by which the functions
  /// below know it; 0 or less if the connection takes no new stream. `events` lives until OnClosed
  /// or Forget.
  [[nodiscard]] std::int32_t Open(const std::vector<Header>& headers, Http2Events& events);
  /// There is more of the body.
  void Resume(std::int32_t stream);
  /// Ends the stream with RST_STREAM.
  void Reset(std::int32_t stream, std::uint32_t error);
  /// Its events are told nothing more.
  void Forget(std::int32_t stream);
  /// So many bytes of it were read; of Window::by_stream alone.
  void Consume(std::int32_t stream, std::size_t bytes);
  /// Bytes from the peer; false if they are not HTTP/2.
  bool Receive(std::string_view bytes);
  /// Appends the bytes to send now.
  void Produce(std::string& out) {
    while (ProduceFrame(out)) {
    }
  }
  /// Appends one HTTP/2 frame; false if there is none.
  bool ProduceFrame(std::string& out);
  /// The server says no GOAWAY so far.
  [[nodiscard]] bool may_open() const;

 private:
  struct Callbacks;

  const bool by_stream_;
  std::unique_ptr<nghttp2_session, void (*)(nghttp2_session*)> session_;
};

}  // namespace uplink::link
