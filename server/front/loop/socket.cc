#include "server/front/loop/socket.h"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <linux/sockios.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace uplink::front {

void Socket::OnReady(std::uint32_t events) {
  if (closed()) return;
  if ((events & EPOLLOUT) != 0) SendKept();
  if (!closed() && (events & ~std::uint32_t{EPOLLOUT}) != 0) Receive();
  owner_.AfterEvent();
}

void Socket::Receive() {
  // Reads once: others have their turn before the rest, which the loop reports again.
  const ssize_t bytes = ::recv(descriptor_, shared_.data(), shared_.size(), MSG_DONTWAIT);
  if (bytes > 0) return owner_.OnReceived({shared_.data(), static_cast<std::size_t>(bytes)});
  if (bytes < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (bytes < 0) error_ = errno;
  owner_.OnReceiveEnd();
}

bool Socket::Send(std::string_view bytes) {
  if (blocked()) {
    kept_.append(bytes);
    return true;
  }
  const ssize_t sent = ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (sent < 0 && errno != EAGAIN && errno != EINTR) {
    error_ = errno;
    return false;
  }
  const auto gone = static_cast<std::size_t>(std::max<ssize_t>(sent, 0));
  sent_ += gone;
  bytes.remove_prefix(gone);
  if (bytes.empty()) return true;
  kept_.assign(bytes);
  loop_.WatchSending(descriptor_, *this, true);
  return true;
}

void Socket::SendKept() {
  if (!blocked()) return;
  const std::string kept = std::exchange(kept_, {});
  if (!Send(kept)) return owner_.OnReceiveEnd();
  if (blocked()) return;
  loop_.WatchSending(descriptor_, *this, false);
  owner_.OnUnblocked();
}

bool Socket::TakesSome() {
  int waiting = 0;
  if (closed() || ::ioctl(descriptor_, SIOCOUTQ, &waiting) != 0) return false;
  const std::uint64_t before = std::exchange(taken_, sent_ - static_cast<std::uint64_t>(waiting));
  return waiting > 0 && taken_ > before;
}

bool Socket::timed_out() const {
  return error_ == ETIMEDOUT || error_ == EHOSTUNREACH || error_ == ENETUNREACH;
}

bool Socket::unanswered() const {
  tcp_info info{};
  socklen_t size = sizeof info;
  if (closed() || ::getsockopt(descriptor_, IPPROTO_TCP, TCP_INFO, &info, &size) != 0) return false;
  return info.tcpi_retransmits >= kUnansweredMax || info.tcpi_probes >= kUnansweredMax;
}

void Socket::EndOutput() {
  if (!closed()) ::shutdown(descriptor_, SHUT_WR);
}

void Socket::Close() {
  if (closed()) return;
  ::close(std::exchange(descriptor_, -1));
  std::string().swap(kept_);
}

}  // namespace uplink::front
