#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/load/load.h"
#include "tests/bench/pinned_server.h"

namespace uplink::bench {

/// What is measured, and what it is measured beside: bare servers, brokers.
enum class ServerKind : std::uint8_t {
  kUplinkd,
  kGrpcSink,
  kTlsSink,
  kMosquitto,
  /// The same server, which clients ask for QoS 0.
  kMosquittoQos0,
  kNats
};
[[nodiscard]] std::string NameOf(ServerKind kind);
/// False for a broker whose package is not installed.
[[nodiscard]] bool IsInstalled(ServerKind kind);

/// One server, pinned to kServerCore, in a process of its own.
///
/// Errors: a server that does not start aborts the benchmark.
/// Thread: confined to one thread.
class Server final {
 public:
  /// `frame_messages` is what the bare gRPC sink counts a frame as; `environment`
  /// (`UPLINKD_...=`) sets what uplinkd has besides.
  Server(const World& world, ServerKind kind, std::size_t frame_messages = 1,
         std::vector<std::string> environment = {});

  [[nodiscard]] Load::Where where() const;
  [[nodiscard]] synthetic::ProcessUse use() const { return UseOf(*process_); }
  /// SIGKILL, and a new process on the same port and store.
  void KillAndStart();

 private:
  void Start();
  /// Of all but uplinkd.
  [[nodiscard]] std::vector<std::string> Command() const;

  const World& world_;
  ServerKind kind_;
  std::size_t frame_messages_;
  std::vector<std::string> environment_;
  std::uint16_t port_ = 0;
  std::unique_ptr<testing::ServerProcess> process_;
};

}  // namespace uplink::bench
