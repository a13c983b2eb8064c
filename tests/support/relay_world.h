#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "metrics/ledger.h"
#include "server/config/config.h"
#include "server/fleet/fleet.h"
#include "server/journal/shards.h"
#include "server/journal/writer.h"
#include "server/session/limits.h"
#include "server/transport/listener.h"
#include "server/transport/options.h"
#include "tests/support/certificates.h"
#include "tests/support/eventually.h"
#include "tests/support/fake_reject_source.h"
#include "tests/support/fake_store.h"
#include "tests/support/fake_trust.h"
#include "tests/support/relay_samples.h"
#include "tests/support/test_agent.h"

namespace uplink::testing {

/// The transport that this run of the tests is about: UPLINK_TEST_TRANSPORT, `grpc` if it is not
/// set.
[[nodiscard]] config::Transport TestedTransport();

/// The real relay on loopback with real sessions, journal and writer thread, on the fake store.
class RelayWorld final {
 public:
  struct Options {
    session::SessionLimits session;
    journal::JournalLimits journal;
    std::size_t robots_max = 1000;
    std::size_t streams_max = 1000;
    std::size_t queues = 2;
    milliseconds connection_age_max{0};
    config::Transport transport = TestedTransport();
    /// What follows is of the native transport alone.
    config::TlsVersion tls_minimum = config::TlsConfig().min_version;
    std::size_t memory_bytes_max = 0;
    std::vector<config::Network> proxy_protocol_from;
    /// Of the lines about strangers; none if null.
    const log::Logger* logger = nullptr;
  };

  RelayWorld() : RelayWorld(Options{}) {}
  explicit RelayWorld(const Options& options);
  /// Releases the store, ends the streams, stops the writer.
  ~RelayWorld();
  RelayWorld(const RelayWorld&) = delete;
  RelayWorld& operator=(const RelayWorld&) = delete;

  [[nodiscard]] transport::Listener& server() { return *server_; }
  /// Stops the server; agents see their streams break.
  void StopServer();
  /// Starts a second server in this world, on `address`.
  [[nodiscard]] absl::StatusOr<std::unique_ptr<transport::Listener>> StartAnother(
      const config::ListenAddress& address, const transport::KeyMaterial& material);

  [[nodiscard]] std::shared_ptr<grpc::Channel> Channel(const std::string& ruri) const;
  [[nodiscard]] std::shared_ptr<grpc::Channel> Channel(const KeyPair& identity) const;
  [[nodiscard]] ChannelSpec SpecFor(const std::string& ruri) const;
  /// What the server shows and trusts.
  [[nodiscard]] transport::PemTexts ServerTexts() const;

  /// The sum of the ledger's pages.
  [[nodiscard]] metrics::UplinkCounts Counts() const { return ledgers.Sum().uplinks; }
  /// True once nothing is in flight and the conservation law holds.
  [[nodiscard]] bool Settles() const;

  SystemClock clock;
  FakeDatabase database;
  FakeStore store{database, storage::ProcessId{1}};
  TestAuthority authority;
  metrics::LedgerBook ledgers;
  journal::JournalProbe journal_probe;
  session::SessionProbe session_probe;
  transport::RelayProbe relay_probe;
  const Options options;
  fleet::Fleet fleet;
  journal::Journal journal;
  journal::Shards shards{{&journal}};

 private:
  [[nodiscard]] transport::RelayContext Context();
  [[nodiscard]] absl::StatusOr<std::unique_ptr<transport::Listener>> Start(
      const transport::RelayOptions& relay_options);

  KeyPair server_identity_;
  const session::Allowances allowances_;
  const FakeTrust clock_trust_;
  FakeRejectSource rejects_{&store};
  std::optional<journal::JournalWriter> writer_;
  std::unique_ptr<transport::Listener> server_;
};

}  // namespace uplink::testing
