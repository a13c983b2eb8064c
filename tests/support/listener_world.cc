#include "tests/support/listener_world.h"

#include <utility>

#include "schema/base/check.h"

namespace uplink::testing {
namespace {

/// Streams of a second server.
constexpr std::size_t kAnotherStreamsMax = 100;

}  // namespace

ListenerWorld::ListenerWorld(const Options& given)
    : options(given),
      fleet(clock, given.robots_max, robot::PresenceLimits{}),
      journal(store, given.journal, clock, ledgers.NewPage(), journal_probe, storage::ProcessId{1}),
      server_identity_(authority.Issue(ServerSpec())) {
  // Short pauses: tests order failures by their number, not by their time.
  writer_.emplace(journal, BackoffLimits{.first = milliseconds(2), .longest = milliseconds(5)},
                  [] { return std::uint64_t{0}; });
  auto started = front::FrontServer::Start({.address = {"127.0.0.1", 0},
                                            .key_material = ServerTexts(),
                                            .queues = options.queues,
                                            .tls = options.tls,
                                            .proxy_protocol_from = options.proxy_protocol_from,
                                            .streams_max = options.streams_max,
                                            .gateway_streams_max = options.gateway_streams_max,
                                            .connection_age_max = options.connection_age_max,
                                            .memory_bytes_max = options.memory_bytes_max},
                                           Context());
  UPLINK_CHECK(started.ok(), started.status().ToString());
  server_ = *std::move(started);
}

ListenerWorld::~ListenerWorld() {
  store.Heal();
  StopServer();
  writer_->Stop();
}

front::RelayContext ListenerWorld::Context() {
  return {.clock = clock,
          .fleet = fleet,
          .journals = shards,
          .session_probe = session_probe,
          .probe = relay_probe,
          .ledgers = ledgers,
          .limits = options.session,
          .judge_limits = {.payload_bytes_max = options.session.payload_bytes_max,
                           .message_bytes_max = options.session.message_bytes_max,
                           .extras_items_max = options.session.extras_items_max},
          .allowances = allowances,
          .rejects = rejects_,
          .clock_trust = clock_trust_,
          .logger = options.logger,
          .denied = &denied};
}

void ListenerWorld::StopServer() { server_->Shutdown(); }

absl::StatusOr<std::unique_ptr<front::FrontServer>> ListenerWorld::StartAnother(
    const config::ListenAddress& address, const transport::KeyMaterial& material,
    std::size_t queues) {
  return front::FrontServer::Start({.address = address,
                                    .key_material = material,
                                    .queues = queues,
                                    .streams_max = kAnotherStreamsMax},
                                   Context());
}

transport::PemTexts ListenerWorld::ServerTexts() const {
  return {.certificate = server_identity_.certificate,
          .key = server_identity_.key,
          .client_ca = authority.certificate()};
}

bool ListenerWorld::Settles() const {
  return Eventually([this] {
    const metrics::MessageCounts counts = Counts();
    return counts.in_flight == 0 && counts.Balanced();
  });
}

}  // namespace uplink::testing
