#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "server/front/limits.h"

namespace uplink::front {

/// Whom a socket tells what happens to it; on its thread, never from within a call to it.
class SocketOwner {
 public:
  virtual ~SocketOwner() = default;
  /// Bytes arrived, valid during the call.
  virtual void OnReceived(std::string_view bytes) = 0;
  /// The peer closed its side, or the connection broke: nothing more comes.
  virtual void OnReceiveEnd() = 0;
  /// All that was kept back has gone out.
  virtual void OnUnblocked() = 0;
  /// After each of the above, or several.
  virtual void AfterEvent() = 0;
  /// After Close: no operation of the system is under way any more.
  virtual void OnQuiet() = 0;
};

/// A connected socket: reads when asked, sends at once and keeps back what does not fit.
///
/// It receives into a small buffer of its own, which takes a paced message whole without a call to
/// wait for it; what is larger comes through the thread's buffer.
/// Thread: confined to its context's.
class Socket final {
 public:
  /// Takes the descriptor over. `shared` is the thread's.
  Socket(boost::asio::io_context& context, int descriptor, SocketOwner& owner,
         std::array<char, kSharedReadBytes>& shared);
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  /// Wants the next bytes; nothing if it waits for them already.
  void Receive();
  /// False if the connection broke.
  [[nodiscard]] bool Send(std::string_view bytes);
  /// Bytes wait for a peer that does not read.
  [[nodiscard]] bool blocked() const { return !kept_.empty(); }
  [[nodiscard]] std::size_t kept_bytes() const { return kept_.size(); }
  /// Tells the peer that nothing follows.
  void EndOutput();
  void Close();
  /// Whether it may be destroyed: closed, and no operation is under way.
  [[nodiscard]] bool quiet() const { return closed_ && operations_ == 0; }

 private:
  void OnReceived(const boost::system::error_code& error, std::size_t bytes);
  void ReceiveMore();
  void WaitToSend();
  void OnSendable(const boost::system::error_code& error);

  boost::asio::ip::tcp::socket socket_;
  SocketOwner& owner_;
  std::array<char, kSharedReadBytes>& shared_;
  std::string kept_;
  int operations_ = 0;
  bool receiving_ = false;
  bool closed_ = false;
  std::array<char, kOwnReadBytes> own_;
};

}  // namespace uplink::front
