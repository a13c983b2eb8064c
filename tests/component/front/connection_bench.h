#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <unordered_map>

#include "server/front/connection.h"
#include "server/front/loop/event_loop.h"
#include "tests/fuzz/front_bench.h"
#include "tests/support/raw_http2.h"

namespace uplink::testing {

/// Real connections, with sockets and TLS, on a loop of their own, and a clock that is moved by
/// hand: what comes after some time comes at once, and not before.
///
/// Thread: one, the test's; connections have theirs.
class ConnectionBench final : public front::ConnectionOwner {
 public:
  explicit ConnectionBench(config::TlsVersion minimum = config::TlsVersion::k13);
  ~ConnectionBench() override;
  ConnectionBench(const ConnectionBench&) = delete;
  ConnectionBench& operator=(const ConnectionBench&) = delete;

  /// Where Accept takes in from.
  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// Takes in the connection that a peer has begun.
  void Accept();
  /// A client that shows this, and is taken in.
  [[nodiscard]] RawHttp2::Options Client(const KeyPair& identity);

  /// Both clocks go on, and what is due is done.
  void Pass(milliseconds time);
  /// The store does all that it has to.
  void Commit();
  /// Does something on the thread of the connections, and waits for it.
  void Do(const std::function<void()>& work);
  /// Ends all connections, as a server that stops does.
  void ShutDown();
  /// These may not come in from now on, and connections are looked at.
  void Deny(identity::DeniedCertificates denied);
  /// What the authorities' entries are from now on, and connections are looked at.
  void Trust(const identity::AuthorityRules& rules);
  /// Others wait for a place.
  void Press();

  [[nodiscard]] std::int64_t TurnedAwayFor(transport::TurnedAway cause);
  /// Connections that hold a descriptor.
  [[nodiscard]] std::size_t open() const { return open_.load(); }
  [[nodiscard]] fuzz::FrontBench& bench() { return bench_; }
  [[nodiscard]] const TestAuthority& authority() const { return authority_; }

  // front::ConnectionOwner
  void OnHandshakeEnded(front::Connection& connection) override;
  void EvictOther(std::uint64_t connection) override;
  void OnClosed(front::Connection& connection) override;

 private:
  void Listen();
  void RunTimers();

  const TestAuthority authority_;
  const KeyPair server_ = authority_.Issue(ServerSpec());
  const transport::TlsRules rules_;
  front::ServedContext tls_;
  fuzz::FrontBench bench_;
  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::uint64_t next_id_ = 1;
  front::EventLoop loop_{{.timer = [] {}, .after = [] {}}};
  std::unordered_map<std::uint64_t, std::unique_ptr<front::Connection>> connections_;
  std::atomic<std::size_t> open_{0};
  std::jthread thread_;
};

}  // namespace uplink::testing
