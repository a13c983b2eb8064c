#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "schema/base/clock.h"
#include "tools/link/loop.h"
#include "tools/link/tls_client.h"

namespace uplink::link {

/// What a link tells its owner: on the loop's thread, never from within a call that the owner
/// makes.
class LinkEvents {
 public:
  virtual ~LinkEvents() = default;
  /// The handshake is done.
  virtual void OnUp() = 0;
  virtual void OnBytes(std::string_view bytes) = 0;
  /// The kernel has taken all bytes that waited.
  virtual void OnSent() = 0;
  /// The link is down. The last event.
  virtual void OnDown(const absl::Status& why) = 0;
};

/// Acks are small.
inline constexpr std::uint32_t kWindowBytes = 256 * 1024;

struct LinkOptions {
  Address address;
  Identity identity;
  std::shared_ptr<const TlsClient> tls;
  /// Each write waits so long before it leaves: a slow network.
  milliseconds delay{0};
  /// What the server may send ahead of its reader, by HTTP/2's windows.
  std::uint32_t window_bytes = kWindowBytes;
  /// False: after so many bytes the server may send nothing more, whatever is read.
  bool window_renewed = true;
  /// Each message leaves in a DATA frame and a TLS record of its own, however many wait.
  bool record_per_message = false;
  /// A line in clear text comes before the handshake (NATS), and is skipped.
  bool greeted_in_clear = false;
};

/// One TCP connection with mutual TLS, and the ways in which a network treats it badly.
///
/// The program ignores SIGPIPE: OpenSSL writes to sockets that the peer has closed.
///
/// Errors: what ends the link comes by OnDown: kUnavailable, with the reason.
/// Thread: confined to the loop's thread.
class TlsLink final : public std::enable_shared_from_this<TlsLink> {
 public:
  /// `events` must live until Close, or OnDown.
  TlsLink(Loop& loop, LinkOptions options, LinkEvents& events);
  ~TlsLink();
  TlsLink(const TlsLink&) = delete;
  TlsLink& operator=(const TlsLink&) = delete;

  void Connect();
  /// Sends the bytes; what the kernel does not take now waits in memory.
  void Write(std::string_view bytes);
  /// Bytes that wait.
  [[nodiscard]] std::size_t unsent() const { return pending_.size(); }

  /// Delays the writes that follow.
  void SetDelay(milliseconds delay) { options_.delay = delay; }
  /// A slow reader: nothing is read until it is called with false.
  void PauseReading(bool pause);
  /// Half-open: nothing leaves, nothing is read, and the peer is told nothing.
  void Freeze();
  /// Ends it with a TCP reset, like a device in between that forgets the connection. No event
  /// comes.
  void Cut();
  /// Ends it in an orderly way. No event comes.
  void Close();

 private:
  enum class State : std::uint8_t { kNew, kConnecting, kGreeting, kHandshake, kUp, kFrozen, kDown };

  void OnConnected(const boost::system::error_code& error);
  void OnReadable();
  void OnWritable();
  void ReadGreeting();
  void Handshake();
  void Read();
  void Flush();
  void ReleaseLater();
  /// What was not sent is lost.
  void Drop();
  void WaitReadable();
  void WaitWritable();
  void Down(const std::string& why);
  void Forget();

  Loop& loop_;
  LinkOptions options_;
  LinkEvents* events_;
  boost::asio::ip::tcp::socket socket_;
  TlsClient::Session session_{nullptr, nullptr};
  std::unique_ptr<boost::asio::steady_timer> delay_timer_;
  /// What was written and has not left. Its first `released_` bytes may leave now; the rest, in
  /// the order of the writes, when each is due.
  std::string pending_;
  std::size_t released_ = 0;
  struct Held {
    SteadyTime due;
    std::size_t bytes;
  };
  std::deque<Held> held_;
  State state_ = State::kNew;
  bool reading_ = false;
  bool writing_ = false;
  bool paused_ = false;
  bool delayed_ = false;
};

}  // namespace uplink::link
