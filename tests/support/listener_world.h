#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "metrics/ledger.h"
#include "server/fleet/fleet.h"
#include "server/front/server.h"
#include "server/journal/shards.h"
#include "server/journal/writer.h"
#include "server/log/logger.h"
#include "server/session/limits.h"
#include "server/transport/options.h"
#include "tests/support/certificates.h"
#include "tests/support/eventually.h"
#include "tests/support/fake_reject_source.h"
#include "tests/support/fake_store.h"
#include "tests/support/fake_trust.h"

namespace uplink::testing {

/// The listener for robots on loopback with real sessions, journal and writer thread, on the fake
/// store.
class ListenerWorld {
 public:
  struct Options {
    session::SessionLimits session;
    journal::JournalLimits journal;
    std::size_t robots_max = 1000;
    std::size_t streams_max = 1000;
    std::size_t gateway_streams_max = config::LimitsConfig().gateway_streams_max;
    std::size_t queues = 2;
    milliseconds connection_age_max{0};
    transport::TlsRules tls{};
    std::size_t memory_bytes_max = 0;
    std::vector<config::Network> proxy_protocol_from;
    /// Of the lines about strangers, and about streams that were refused; none if null.
    const log::Logger* logger = nullptr;
  };

  explicit ListenerWorld(const Options& options);
  /// Releases the store, ends the streams, stops the writer.
  ~ListenerWorld();
  ListenerWorld(const ListenerWorld&) = delete;
  ListenerWorld& operator=(const ListenerWorld&) = delete;

  [[nodiscard]] front::FrontServer& server() { return *server_; }
  [[nodiscard]] std::uint16_t port() const { return server_->port(); }
  /// Stops the server; agents see their streams break.
  void StopServer();
  /// Starts a second server in this world, on `address`, with this many threads.
  [[nodiscard]] absl::StatusOr<std::unique_ptr<front::FrontServer>> StartAnother(
      const config::ListenAddress& address, const transport::KeyMaterial& material,
      std::size_t queues = 1);

  /// What the server shows and trusts.
  [[nodiscard]] transport::PemTexts ServerTexts() const;

  /// The sum of the ledger's pages.
  [[nodiscard]] metrics::MessageCounts Counts() const { return ledgers.Sum().messages; }
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
  identity::DenyList denied;
  const Options options;
  fleet::Fleet fleet;
  journal::Journal journal;
  journal::Shards shards{{&journal}};
  ingest::Allowances allowances;

 private:
  [[nodiscard]] front::RelayContext Context();

  KeyPair server_identity_;
  const FakeTrust clock_trust_;
  FakeRejectSource rejects_{&store};
  std::optional<journal::JournalWriter> writer_;
  std::unique_ptr<front::FrontServer> server_;
};

}  // namespace uplink::testing
