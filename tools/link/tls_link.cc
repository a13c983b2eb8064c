#include "tools/link/tls_link.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <boost/asio/connect.hpp>
#include <fmt/core.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/socket.h>

namespace uplink::link {
namespace {

using boost::asio::socket_base;
using boost::asio::ip::tcp;
using boost::system::error_code;
using SteadyClock = SteadyTime::clock;

/// A peer that acknowledges nothing for so long is gone.
constexpr unsigned kUserTimeoutMs = 20'000;
/// A buffer that once was larger is given back when it is empty.
constexpr std::size_t kKeptBytes = 4 * 1024;

bool WantsMore(int error) { return error == SSL_ERROR_WANT_READ || error == SSL_ERROR_WANT_WRITE; }

}  // namespace

TlsLink::TlsLink(Loop& loop, LinkOptions options, LinkEvents& events)
    : loop_(loop), options_(std::move(options)), events_(&events), socket_(loop.io) {}

TlsLink::~TlsLink() = default;

void TlsLink::Connect() {
  state_ = State::kConnecting;
  boost::asio::async_connect(
      socket_, options_.address.endpoints,
      [self = shared_from_this()](const error_code& error, const tcp::endpoint& /*to*/) {
        self->OnConnected(error);
      });
}

void TlsLink::OnConnected(const error_code& error) {
  if (state_ != State::kConnecting) return;
  if (error) return Down(error.message());
  error_code ignored;
  socket_.set_option(tcp::no_delay(true), ignored);
  socket_.non_blocking(true, ignored);
  setsockopt(socket_.native_handle(), IPPROTO_TCP, TCP_USER_TIMEOUT, &kUserTimeoutMs,
             sizeof kUserTimeoutMs);
  session_ = options_.tls->NewSession(options_.identity, options_.address.host);
  SSL_set_fd(session_.get(), socket_.native_handle());
  if (options_.greeted_in_clear) {
    state_ = State::kGreeting;
    WaitReadable();
  } else {
    state_ = State::kHandshake;
    Handshake();
  }
}

void TlsLink::ReadGreeting() {
  char byte = 0;
  error_code error;
  // A byte at a time: what follows the line is TLS.
  while (socket_.read_some(boost::asio::buffer(&byte, 1), error) == 1) {
    if (byte != '\n') continue;
    state_ = State::kHandshake;
    return Handshake();
  }
  if (error != boost::asio::error::would_block) return Down(error.message());
  WaitReadable();
}

void TlsLink::Handshake() {
  ERR_clear_error();
  const int done = SSL_do_handshake(session_.get());
  if (done == 1) {
    state_ = State::kUp;
    const auto self = shared_from_this();
    events_->OnUp();
    if (state_ == State::kUp) WaitReadable();
    return;
  }
  const int error = SSL_get_error(session_.get(), done);
  if (error == SSL_ERROR_WANT_READ) return WaitReadable();
  if (error == SSL_ERROR_WANT_WRITE) return WaitWritable();
  Down("TLS handshake: " + TakeTlsError());
}

void TlsLink::WaitReadable() {
  if (reading_ || paused_ || state_ == State::kDown || state_ == State::kFrozen) return;
  reading_ = true;
  socket_.async_wait(socket_base::wait_read, [self = shared_from_this()](const error_code& error) {
    self->reading_ = false;
    if (!error) self->OnReadable();
  });
}

void TlsLink::WaitWritable() {
  if (writing_ || state_ == State::kDown || state_ == State::kFrozen) return;
  writing_ = true;
  socket_.async_wait(socket_base::wait_write, [self = shared_from_this()](const error_code& error) {
    self->writing_ = false;
    if (!error) self->OnWritable();
  });
}

void TlsLink::OnReadable() {
  if (paused_) return;
  if (state_ == State::kGreeting) return ReadGreeting();
  if (state_ == State::kHandshake) return Handshake();
  if (state_ == State::kUp) Read();
}

void TlsLink::OnWritable() {
  if (state_ == State::kHandshake) return Handshake();
  if (state_ != State::kUp) return;
  Flush();
  if (state_ == State::kUp && pending_.empty()) events_->OnSent();
}

void TlsLink::Read() {
  const auto self = shared_from_this();
  while (state_ == State::kUp && !paused_) {
    // What another connection of this thread left there is not this one's.
    ERR_clear_error();
    const int got = SSL_read(session_.get(), loop_.in.data(), static_cast<int>(loop_.in.size()));
    if (got > 0) {
      events_->OnBytes({loop_.in.data(), static_cast<std::size_t>(got)});
      continue;
    }
    const int error = SSL_get_error(session_.get(), got);
    if (error == SSL_ERROR_WANT_READ) return WaitReadable();
    if (error == SSL_ERROR_WANT_WRITE) return WaitWritable();
    return Down(error == SSL_ERROR_ZERO_RETURN ? "the server closed the connection"
                                               : "connection lost: " + TakeTlsError());
  }
}

void TlsLink::Write(std::string_view bytes) {
  if (state_ != State::kUp) return;
  ERR_clear_error();
  if (pending_.empty() && options_.delay.count() == 0) {
    while (!bytes.empty()) {
      const int put = SSL_write(session_.get(), bytes.data(), static_cast<int>(bytes.size()));
      if (put <= 0) {
        if (WantsMore(SSL_get_error(session_.get(), put))) break;
        // What the peer said last is still to be read; the read says that it is over.
        static_cast<void>(TakeTlsError());
        return;
      }
      bytes.remove_prefix(static_cast<std::size_t>(put));
    }
    if (bytes.empty()) return;
  }
  pending_.append(bytes);
  if (held_.empty() && options_.delay.count() == 0) {
    released_ += bytes.size();
    return WaitWritable();
  }
  // In the order of the writes, also when the delay became shorter meanwhile.
  const SteadyTime due = SteadyClock::now() + options_.delay;
  held_.push_back({held_.empty() ? due : std::max(due, held_.back().due), bytes.size()});
  ReleaseLater();
}

void TlsLink::ReleaseLater() {
  if (held_.empty() || std::exchange(delayed_, true)) return;
  if (delay_timer_ == nullptr) {
    delay_timer_ = std::make_unique<boost::asio::steady_timer>(loop_.io);
  }
  delay_timer_->expires_at(held_.front().due);
  delay_timer_->async_wait([self = shared_from_this()](const error_code& error) {
    self->delayed_ = false;
    if (error || self->state_ != State::kUp) return;
    for (const SteadyTime now = SteadyClock::now();
         !self->held_.empty() && self->held_.front().due <= now; self->held_.pop_front()) {
      self->released_ += self->held_.front().bytes;
    }
    self->ReleaseLater();
    if (!self->writing_) self->OnWritable();
  });
}

void TlsLink::Flush() {
  ERR_clear_error();
  std::size_t done = 0;
  while (done < released_) {
    const int put =
        SSL_write(session_.get(), pending_.data() + done, static_cast<int>(released_ - done));
    if (put <= 0) {
      if (WantsMore(SSL_get_error(session_.get(), put))) break;
      static_cast<void>(TakeTlsError());
      return Drop();
    }
    done += static_cast<std::size_t>(put);
  }
  pending_.erase(0, done);
  released_ -= done;
  if (released_ > 0) return WaitWritable();
  if (pending_.empty() && pending_.capacity() > kKeptBytes) std::string().swap(pending_);
}

void TlsLink::Drop() {
  std::string().swap(pending_);
  held_.clear();
  released_ = 0;
}

void TlsLink::PauseReading(bool pause) {
  paused_ = pause;
  if (!pause && state_ == State::kUp) WaitReadable();
}

void TlsLink::Freeze() {
  if (state_ == State::kDown) return;
  state_ = State::kFrozen;
  error_code ignored;
  socket_.cancel(ignored);
}

void TlsLink::Cut() {
  error_code ignored;
  socket_.set_option(socket_base::linger(true, 0), ignored);
  Forget();
}

void TlsLink::Close() {
  if (state_ == State::kUp) SSL_shutdown(session_.get());
  Forget();
}

void TlsLink::Down(const std::string& why) {
  if (state_ == State::kDown) return;
  LinkEvents* const events = events_;
  Forget();
  // The last thing that is done: the owner may drop the link.
  if (events != nullptr) events->OnDown(absl::UnavailableError(why));
}

void TlsLink::Forget() {
  state_ = State::kDown;
  events_ = nullptr;
  error_code ignored;
  socket_.close(ignored);
  if (delay_timer_ != nullptr) delay_timer_->cancel();
  Drop();
}

}  // namespace uplink::link
