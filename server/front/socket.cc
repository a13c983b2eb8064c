#include "server/front/socket.h"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <sys/socket.h>
#include <unistd.h>

namespace uplink::front {

namespace asio = boost::asio;

Socket::Socket(asio::io_context& context, int descriptor, SocketOwner& owner,
               std::array<char, kSharedReadBytes>& shared)
    : socket_(context), owner_(owner), shared_(shared) {
  boost::system::error_code ignored;
  // The family only matters to calls that are not made here.
  socket_.assign(asio::ip::tcp::v6(), descriptor, ignored);
  if (ignored) ::close(descriptor);
  socket_.native_non_blocking(true, ignored);
}

void Socket::Receive() {
  if (closed_ || std::exchange(receiving_, true)) return;
  ++operations_;
  socket_.async_receive(asio::buffer(own_),
                        [this](const boost::system::error_code& error, std::size_t bytes) {
                          OnReceived(error, bytes);
                        });
}

void Socket::OnReceived(const boost::system::error_code& error, std::size_t bytes) {
  --operations_;
  receiving_ = false;
  if (closed_) {
    if (quiet()) owner_.OnQuiet();
    return;
  }
  if (error) {
    owner_.OnReceiveEnd();
  } else {
    owner_.OnReceived({own_.data(), bytes});
    // With the own buffer full there is likely more.
    if (bytes == own_.size() && !closed_) ReceiveMore();
  }
  owner_.AfterEvent();
}

void Socket::ReceiveMore() {
  const ssize_t more =
      ::recv(socket_.native_handle(), shared_.data(), shared_.size(), MSG_DONTWAIT);
  if (more > 0) return owner_.OnReceived({shared_.data(), static_cast<std::size_t>(more)});
  if (more == 0 || (errno != EAGAIN && errno != EINTR)) owner_.OnReceiveEnd();
}

bool Socket::Send(std::string_view bytes) {
  if (blocked()) {
    kept_.append(bytes);
    return true;
  }
  const ssize_t sent = ::send(socket_.native_handle(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (sent < 0 && errno != EAGAIN && errno != EINTR) return false;
  bytes.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(sent, 0)));
  if (bytes.empty()) return true;
  kept_.assign(bytes);
  WaitToSend();
  return true;
}

void Socket::WaitToSend() {
  ++operations_;
  socket_.async_wait(asio::socket_base::wait_write,
                     [this](const boost::system::error_code& error) { OnSendable(error); });
}

void Socket::OnSendable(const boost::system::error_code& error) {
  --operations_;
  if (closed_) {
    if (quiet()) owner_.OnQuiet();
    return;
  }
  if (error) {
    owner_.OnReceiveEnd();
    return owner_.AfterEvent();
  }
  const std::string kept = std::exchange(kept_, {});
  if (!Send(kept)) {
    owner_.OnReceiveEnd();
  } else if (!blocked()) {
    owner_.OnUnblocked();
  }
  owner_.AfterEvent();
}

void Socket::EndOutput() {
  boost::system::error_code ignored;
  socket_.shutdown(asio::socket_base::shutdown_send, ignored);
}

void Socket::Close() {
  if (std::exchange(closed_, true)) return;
  boost::system::error_code ignored;
  socket_.close(ignored);
  std::string().swap(kept_);
}

}  // namespace uplink::front
