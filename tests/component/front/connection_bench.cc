#include "tests/component/front/connection_bench.h"

#include <future>
#include <string>
#include <utility>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "schema/base/check.h"
#include "server/config/tls_groups.h"

namespace uplink::testing {
namespace {

constexpr std::uint32_t kGatewayStreamsMax = 16;

std::string GroupsOf(config::TlsVersion minimum) {
  config::TlsConfig tls;
  tls.min_version = minimum;
  return config::ServedGroups(tls);
}

}  // namespace

ConnectionBench::ConnectionBench(config::TlsVersion minimum)
    : rules_{.minimum = minimum, .groups = GroupsOf(minimum)} {
  Trust({});
  // Certificates are judged by the machine's clock.
  bench_.clock().SetSystem(SystemClock{}.System());
  Listen();
  thread_ = std::jthread([this] { loop_.Run(); });
}

ConnectionBench::~ConnectionBench() {
  ShutDown();
  loop_.Post([this] { loop_.Stop(); });
  thread_.join();
  ::close(listener_);
}

void ConnectionBench::ShutDown() {
  Do([this] {
    for (const auto& [id, connection] : connections_) connection->Shutdown();
  });
}

void ConnectionBench::Listen() {
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  UPLINK_CHECK(::bind(listener_, any, size) == 0 && ::listen(listener_, SOMAXCONN) == 0 &&
                   ::getsockname(listener_, any, &size) == 0,
               "a test can listen on loopback");
  port_ = ntohs(address.sin_port);
}

void ConnectionBench::Accept() {
  const int descriptor = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  UPLINK_CHECK(descriptor >= 0, "a peer has begun a connection");
  Do([this, descriptor] {
    const std::uint64_t id = next_id_++;
    auto& connection = connections_[id];
    connection = std::make_unique<front::Connection>(
        bench_.thread(), loop_, *this,
        front::Connection::Setup{.id = id,
                                 .descriptor = descriptor,
                                 .origin = {},
                                 .tls = tls_.get(),
                                 .served = &tls_,
                                 .gateway_streams_max = kGatewayStreamsMax});
    ++open_;
    connection->Start();
  });
}

RawHttp2::Options ConnectionBench::Client(const KeyPair& identity) {
  RawHttp2::Options options;
  options.port = port_;
  options.server_ca = authority_.certificate();
  options.identity = identity;
  options.at_first = [this](RawTcp& /*connection*/) { Accept(); };
  return options;
}

void ConnectionBench::Pass(milliseconds time) {
  Do([this, time] {
    bench_.Pass(time);
    RunTimers();
  });
}

void ConnectionBench::RunTimers() {
  front::Thread& thread = bench_.thread();
  while (const std::optional<std::uint64_t> id =
             thread.connection_timers.PopDue(thread.clock.Steady())) {
    connections_.at(*id)->OnTimer();
  }
}

void ConnectionBench::Commit() {
  Do([this] { bench_.Commit(); });
}

void ConnectionBench::Do(const std::function<void()>& work) {
  std::promise<void> done;
  loop_.Post([&] {
    bench_.thread().clock.Advance();
    work();
    done.set_value();
  });
  done.get_future().wait();
}

void ConnectionBench::Deny(identity::DeniedCertificates denied) {
  bench_.denied().Set(std::make_shared<const identity::DeniedCertificates>(std::move(denied)));
  Do([this] {
    for (const auto& [id, connection] : connections_) connection->LookAtDenied();
  });
}

void ConnectionBench::Trust(const identity::AuthorityRules& rules) {
  auto made = front::TlsContext::Make({.certificate = server_.certificate,
                                       .key = server_.key,
                                       .client_ca = authority_.certificate(),
                                       .rules = rules},
                                      rules_);
  UPLINK_CHECK(made.ok(), made.status().ToString());
  tls_.Set(*std::move(made));
  if (!thread_.joinable()) return;
  Do([this] {
    for (const auto& [id, connection] : connections_) connection->LookAtAuthorities(*tls_.get());
  });
}

void ConnectionBench::Press() {
  Do([this] { bench_.door_book().SetPressed(true); });
}

std::int64_t ConnectionBench::TurnedAwayFor(transport::TurnedAway cause) {
  return bench_.relay_probe().turned_away_total[static_cast<std::size_t>(cause)].value();
}

void ConnectionBench::OnHandshakeEnded(front::Connection& /*connection*/) {}

void ConnectionBench::EvictOther(std::uint64_t connection) {
  loop_.Post([this, connection] {
    if (const auto found = connections_.find(connection); found != connections_.end()) {
      found->second->Evict();
    }
  });
}

void ConnectionBench::OnClosed(front::Connection& connection) {
  --open_;
  loop_.Post([this, id = connection.id()] { connections_.erase(id); });
}

}  // namespace uplink::testing
