#include "server/mqtt/asio_link.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <fmt/core.h>
#include <openssl/ssl.h>

#include "server/identity/certificate_gate.h"
#include "server/identity/certificate_messages.h"
#include "server/mqtt/limits.h"
#include "server/mqtt/tls_context.h"

namespace uplink::mqtt {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using Error = boost::system::error_code;

class AsioLink final : public Link, public std::enable_shared_from_this<AsioLink> {
 public:
  AsioLink(asio::io_context& io, LinkEvents& events)
      : events_(&events), resolver_(io), socket_(io), timer_(io), read_timer_(io) {}

  void Open(const Url& url, const TlsTexts& tls) override;
  void Read() override;
  [[nodiscard]] std::string_view input() const override { return {input_.data(), input_bytes_}; }
  [[nodiscard]] std::size_t unread() const override {
    Error error;
    const std::size_t bytes = socket_.is_open() ? socket_.available(error) : 0;
    return error ? 0 : bytes;
  }
  void Write(std::string bytes) override;
  void WakeAt(SteadyTime time) override;
  void Close(std::string last) override;

 private:
  /// Posted, since no event may come from within a method.
  void Down(EndReason reason, std::string text);
  [[nodiscard]] absl::Status PrepareTls(const Url& url, const TlsTexts& tls);
  void Connect(const tcp::resolver::results_type& found);
  void Handshake();
  void Up();
  /// With so many unread bytes the system reports them.
  void WakeFrom(std::size_t bytes);
  void StartReading();
  void ReadEnded(const Error& error, std::size_t bytes);
  /// Whether there are bytes that were not passed on.
  [[nodiscard]] bool HasMore();
  void StartWriting();
  void WriteEnded(const Error& error);
  void CloseNow();

  /// Null once its owner has let go of it.
  LinkEvents* events_;
  tcp::resolver resolver_;
  tcp::socket socket_;
  asio::steady_timer timer_;
  asio::steady_timer read_timer_;
  std::optional<asio::ssl::context> context_;
  std::optional<asio::ssl::stream<tcp::socket&>> tls_;
  /// Checks the certificates at the broker's address before OpenSSL reads them: any peer may answer
  /// there.
  std::optional<identity::CertificateMessages> certificates_;
  bool up_ = false;
  bool reading_ = false;
  bool writing_ = false;
  /// When the last read ended, and whether it came soon after the one before.
  asio::steady_timer::time_point read_at_{};
  bool busy_ = false;
  std::vector<char> input_;
  std::size_t input_bytes_ = 0;
  std::string output_;
  /// Sent after it, at the end.
  std::string last_;
};

void AsioLink::Open(const Url& url, const TlsTexts& tls) {
  if (url.tls) {
    if (absl::Status good = PrepareTls(url, tls); !good.ok()) {
      return Down(EndReason::kSettings, std::string(good.message()));
    }
  }
  resolver_.async_resolve(
      url.host, std::to_string(url.port), tcp::resolver::numeric_service,
      [self = shared_from_this()](const Error& error, const tcp::resolver::results_type& found) {
        if (self->events_ == nullptr) return;
        if (error) {
          return self->events_->OnDown(
              {EndReason::kResolve, "the broker's name has no address: " + error.message()});
        }
        self->Connect(found);
      });
}

absl::Status AsioLink::PrepareTls(const Url& url, const TlsTexts& tls) {
  auto context = MakeSslContext(tls);
  if (!context.ok()) return context.status();
  context_.emplace(context->release());
  tls_.emplace(socket_, *context_);
  certificates_.emplace(tls_->native_handle());
  return AskForHost(tls_->native_handle(), url);
}

void AsioLink::Connect(const tcp::resolver::results_type& found) {
  events_->OnPhase(LinkPhase::kConnecting);
  if (events_ == nullptr) return;
  asio::async_connect(
      socket_, found, [self = shared_from_this()](const Error& error, const tcp::endpoint&) {
        if (self->events_ == nullptr) return;
        if (error) {
          return self->events_->OnDown(
              {EndReason::kConnect, "no one accepts the connection: " + error.message()});
        }
        Error ignored;
        self->socket_.set_option(tcp::no_delay(true), ignored);
        if (!self->tls_) return self->Up();
        self->Handshake();
      });
}

void AsioLink::Handshake() {
  events_->OnPhase(LinkPhase::kHandshaking);
  if (events_ == nullptr) return;
  tls_->async_handshake(
      asio::ssl::stream_base::client, [self = shared_from_this()](const Error& error) {
        if (self->events_ == nullptr) return;
        if (!error) return self->Up();
        if (error.category() == asio::error::get_ssl_category()) {
          self->certificates_->NoteFailure(static_cast<unsigned int>(error.value()));
        }
        const identity::CertificateFlaw flaw = self->certificates_->flaw();
        const std::string why =
            flaw == identity::CertificateFlaw::kNone
                ? VerifyText(self->tls_->native_handle())
                : fmt::format("the broker's certificates are refused: {}", identity::TextOf(flaw));
        self->events_->OnDown({EndReason::kTls, fmt::format("the TLS handshake failed: {}",
                                                            why.empty() ? error.message() : why)});
      });
}

void AsioLink::Up() {
  up_ = true;
  input_.resize(kReadBytes);
  events_->OnUp();
}

void AsioLink::Read() {
  reading_ = true;
  input_bytes_ = 0;
  if (!busy_ || HasMore()) return StartReading();
  // A broker sends each message by itself, and the system would wake us for each of them.
  WakeFrom(kReadBytes);
  read_timer_.expires_after(kReadPause);
  read_timer_.async_wait([self = shared_from_this()](const Error& error) {
    if (error || self->events_ == nullptr) return;
    self->WakeFrom(1);
    self->StartReading();
  });
}

void AsioLink::WakeFrom(std::size_t bytes) {
  Error ignored;
  socket_.set_option(asio::socket_base::receive_low_watermark(static_cast<int>(bytes)), ignored);
}

void AsioLink::StartReading() {
  auto done = [self = shared_from_this()](const Error& error, std::size_t bytes) {
    self->ReadEnded(error, bytes);
  };
  if (tls_) return tls_->async_read_some(asio::buffer(input_), std::move(done));
  socket_.async_read_some(asio::buffer(input_), std::move(done));
}

bool AsioLink::HasMore() {
  if (unread() > 0) return true;
  if (!tls_) return false;
  SSL* const ssl = tls_->native_handle();
  return SSL_pending(ssl) > 0 || BIO_ctrl_pending(SSL_get_rbio(ssl)) > 0;
}

void AsioLink::ReadEnded(const Error& error, std::size_t bytes) {
  reading_ = false;
  if (events_ == nullptr) return;
  const auto now = asio::steady_timer::clock_type::now();
  busy_ = now - read_at_ < 2 * kReadPause;
  read_at_ = now;
  if (!error) {
    input_bytes_ = bytes;
    return events_->OnRead();
  }
  // An end without TLS's close_notify still counts as one: brokers often leave that out.
  if (error == asio::error::eof || error == asio::ssl::error::stream_truncated) {
    return events_->OnDown({EndReason::kClosed, "the broker closed the connection"});
  }
  events_->OnDown({EndReason::kBroken, "the connection broke: " + error.message()});
}

void AsioLink::Write(std::string bytes) {
  output_ = std::move(bytes);
  StartWriting();
}

void AsioLink::StartWriting() {
  writing_ = true;
  auto done = [self = shared_from_this()](const Error& error, std::size_t) {
    self->WriteEnded(error);
  };
  if (tls_) return asio::async_write(*tls_, asio::buffer(output_), std::move(done));
  asio::async_write(socket_, asio::buffer(output_), std::move(done));
}

void AsioLink::WriteEnded(const Error& error) {
  writing_ = false;
  if (events_ == nullptr) {
    if (error || last_.empty()) return CloseNow();
    output_ = std::exchange(last_, {});
    return StartWriting();
  }
  if (!error) return events_->OnWritten();
  if (reading_) return;  // the read tells, after what is still there
  events_->OnDown({EndReason::kBroken, "the connection broke: " + error.message()});
}

void AsioLink::WakeAt(SteadyTime time) {
  timer_.expires_at(time);
  timer_.async_wait([self = shared_from_this()](const Error& error) {
    if (!error && self->events_ != nullptr) self->events_->OnDue();
  });
}

void AsioLink::Close(std::string last) {
  events_ = nullptr;
  last_ = std::move(last);
  if (!up_ || (!writing_ && last_.empty())) return CloseNow();
  timer_.expires_after(kFarewellWait);
  timer_.async_wait([self = shared_from_this()](const Error& error) {
    if (!error) self->CloseNow();
  });
  if (writing_) return;
  output_ = std::exchange(last_, {});
  StartWriting();
}

void AsioLink::CloseNow() {
  timer_.cancel();
  read_timer_.cancel();
  resolver_.cancel();
  Error ignored;
  socket_.shutdown(tcp::socket::shutdown_both, ignored);
  socket_.close(ignored);
}

void AsioLink::Down(EndReason reason, std::string text) {
  asio::post(socket_.get_executor(),
             [self = shared_from_this(), end = End{reason, std::move(text)}] {
               if (self->events_ != nullptr) self->events_->OnDown(end);
             });
}

}  // namespace

std::shared_ptr<Link> MakeAsioLink(asio::io_context& io, LinkEvents& events) {
  return std::make_shared<AsioLink>(io, events);
}

}  // namespace uplink::mqtt
