#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/load/load.h"
#include "tests/support/certificates.h"
#include "tests/support/server_process.h"
#include "tests/support/uplinkd_folder.h"
#include "tools/uplink-fleet/report/process_use.h"

namespace uplink::bench {

/// What is measured, and what it is measured beside.
enum class ServerKind : std::uint8_t { kUplinkd, kGrpcSink, kTlsSink, kMosquitto, kNats };
[[nodiscard]] std::string NameOf(ServerKind kind);
/// False for a broker whose package is not installed.
[[nodiscard]] bool IsInstalled(ServerKind kind);

/// The core that servers run on, and that of the load. With one core, both are that.
inline constexpr int kServerCore = 0;
inline constexpr int kLoadCore = 1;
/// Binds this thread, and what it starts, to a core; false if the machine has none of that number.
bool PinTo(int core);

/// Robots' certificates, and which authorities servers and robots trust; for a whole run.
struct World {
  /// Makes certificates until there are so many.
  void MakeRobots(std::size_t robots);

  testing::UplinkdFolder folder;
  std::vector<link::Identity> identities;
};

/// One server, pinned to kServerCore, in a process of its own.
///
/// Errors: a server that does not start aborts the benchmark.
/// Thread: confined to one thread.
class Server final {
 public:
  /// `frame_messages` is what the bare gRPC sink counts a frame as.
  Server(const World& world, ServerKind kind, std::size_t frame_messages = 1);

  [[nodiscard]] Load::Where where() const;
  [[nodiscard]] synthetic::ProcessUse use() const;
  /// SIGKILL, and a new process on the same port and store.
  void KillAndStart();

 private:
  void Start();

  const World& world_;
  ServerKind kind_;
  std::size_t frame_messages_;
  std::string folder_;
  std::uint16_t port_ = 0;
  std::unique_ptr<testing::ServerProcess> process_;
};

}  // namespace uplink::bench
