#include "server/loop/handshake_probe.h"

#include <array>
#include <memory>
#include <string>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/tcp_stream.hpp>

#include "server/loop/client_hello.h"

namespace uplink::loop {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;

/// One handshake under way; keeps itself alive by its handlers.
class Probe final : public std::enable_shared_from_this<Probe> {
 public:
  Probe(asio::io_context& io, std::function<void(bool)> done)
      : stream_(io), hello_(MakeClientHello()), done_(std::move(done)) {}

  void Start(const tcp::endpoint& endpoint, milliseconds wait) {
    stream_.expires_after(wait);
    stream_.async_connect(endpoint, [self = shared_from_this()](beast::error_code error) {
      if (error) return self->done_(false);
      self->SendHello();
    });
  }

 private:
  void SendHello() {
    asio::async_write(stream_, asio::buffer(hello_),
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        if (error) return self->done_(false);
                        self->ReadAnswer();
                      });
  }

  void ReadAnswer() {
    asio::async_read(stream_, asio::buffer(answer_),
                     [self = shared_from_this()](beast::error_code error, std::size_t bytes) {
                       self->done_(!error && IsServerHello({self->answer_.data(), bytes}));
                     });
  }

  beast::tcp_stream stream_;
  const std::string hello_;
  std::array<char, kServerHelloPrefix> answer_{};
  const std::function<void(bool)> done_;
};

}  // namespace

void ProbeHandshake(EventLoop& loop, const config::ListenAddress& address, milliseconds wait,
                    std::function<void(bool)> done) {
  beast::error_code error;
  asio::ip::address target = asio::ip::make_address(address.host, error);
  if (error) return done(false);
  if (target.is_unspecified()) {
    // A listener on [::] takes both families; the machine may have no IPv6, but then it bound none.
    target = target.is_v6() ? asio::ip::address(asio::ip::address_v6::loopback())
                            : asio::ip::address(asio::ip::address_v4::loopback());
  }
  std::make_shared<Probe>(loop.io(), std::move(done))
      ->Start(tcp::endpoint(target, address.port), wait);
}

}  // namespace uplink::loop
