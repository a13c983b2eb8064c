#include "server/loop/handshake_probe.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>

#include "server/loop/client_hello.h"

namespace uplink::loop {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

/// Where to ask, one after the other.
using Targets = std::vector<tcp::endpoint>;

/// True if nothing can be asked at this address: the machine lacks the address or its whole family,
/// or nothing listens there. After a connection, or a wait for one, something was asked.
bool IsNobodyThere(const error_code& error) {
  using std::errc;
  constexpr std::array kNobody = {
      errc::address_family_not_supported,
      errc::protocol_not_supported,
      errc::address_not_available,
      errc::network_unreachable,
      errc::host_unreachable,
      errc::connection_refused,
      errc::permission_denied,
      errc::operation_not_permitted,  // a rule of a firewall
  };
  return std::ranges::any_of(kNobody, [&](errc each) {
    return error.value() == static_cast<int>(each) &&
           error.category() == asio::error::system_category;
  });
}

/// One handshake under way; keeps itself alive by its handlers.
class Probe final : public std::enable_shared_from_this<Probe> {
 public:
  Probe(asio::io_context& io, Targets targets, const ProbeTarget& target,
        std::function<void(bool)> done)
      : socket_(io),
        late_(io),
        targets_(std::move(targets)),
        proxy_protocol_from_(target.proxy_protocol_from),
        proxy_header_(target.proxy_header),
        own_port_(target.own_port),
        hello_(MakeClientHello()),
        done_(std::move(done)) {}

  void Start(milliseconds wait) {
    late_.expires_after(wait);  // for all that follows
    late_.async_wait([weak = weak_from_this()](error_code error) {
      const auto self = weak.lock();
      if (error || self == nullptr) return;
      self->is_late_ = true;
      self->socket_.close(error);
    });
    Connect(0);
  }

 private:
  /// Takes a port before the listener can see it, and tells it. Where that fails, connecting does
  /// or takes a port of its own.
  void TakePort(const tcp::endpoint& target) {
    if (own_port_ == nullptr) return;
    error_code error;
    socket_.open(target.protocol(), error);
    if (!error) socket_.bind({target.protocol(), 0}, error);
    if (error) return;
    const tcp::endpoint own = socket_.local_endpoint(error);
    if (!error) own_port_->store(own.port());
  }

  void Connect(std::size_t target) {
    TakePort(targets_[target]);
    socket_.async_connect(targets_[target], [self = shared_from_this(), target](error_code error) {
      if (!error) return self->SendHello();
      const std::size_t next = target + 1;
      if (self->is_late_ || next == self->targets_.size() || !IsNobodyThere(error)) {
        return self->done_(false);
      }
      // The socket belongs to the family that it was opened for.
      self->socket_.close(error);
      self->Connect(next);
    });
  }

  /// A listener on this machine sees us come from the address at which we asked it, mostly.
  [[nodiscard]] bool IsLoadBalancer() {
    error_code error;
    const tcp::endpoint own = socket_.local_endpoint(error);
    sockaddr_storage address{};
    if (!error) std::memcpy(&address, own.data(), own.size());
    return config::Contains(proxy_protocol_from_, address);
  }

  void SendHello() {
    if (IsLoadBalancer()) hello_.insert(0, proxy_header_);
    asio::async_write(socket_, asio::buffer(hello_),
                      [self = shared_from_this()](error_code error, std::size_t) {
                        if (error) return self->done_(false);
                        self->ReadAnswer();
                      });
  }

  void ReadAnswer() {
    asio::async_read(socket_, asio::buffer(answer_),
                     [self = shared_from_this()](error_code error, std::size_t bytes) {
                       self->done_(!error && IsServerHello({self->answer_.data(), bytes}));
                     });
  }

  tcp::socket socket_;
  asio::steady_timer late_;
  bool is_late_ = false;
  const Targets targets_;
  const std::vector<config::Network> proxy_protocol_from_;
  const std::string proxy_header_;
  std::atomic<std::uint16_t>* const own_port_;
  std::string hello_;
  std::array<char, kServerHelloPrefix> answer_{};
  const std::function<void(bool)> done_;
};

/// A listener on [::] takes both families, and IPv4 alone where the machine has no IPv6.
Targets TargetsOf(const asio::ip::address& address, std::uint16_t port) {
  if (!address.is_unspecified()) return {{address, port}};
  Targets targets;
  if (address.is_v6()) targets.emplace_back(asio::ip::address_v6::loopback(), port);
  targets.emplace_back(asio::ip::address_v4::loopback(), port);
  return targets;
}

}  // namespace

void ProbeHandshake(EventLoop& loop, const ProbeTarget& target, milliseconds wait,
                    std::function<void(bool)> done) {
  error_code error;
  const asio::ip::address address = asio::ip::make_address(target.address.host, error);
  if (error) return done(false);
  std::make_shared<Probe>(loop.io(), TargetsOf(address, target.address.port), target,
                          std::move(done))
      ->Start(wait);
}

}  // namespace uplink::loop
