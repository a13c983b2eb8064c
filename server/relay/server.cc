#include "server/relay/server.h"

#include <algorithm>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <sched.h>

#include "server/relay/channel_arguments.h"
#include "server/relay/credentials.h"
#include "server/relay/gate.h"
#include "server/relay/listenable.h"
#include "server/relay/queue.h"
#include "server/relay/served_files.h"
#include "server/relay/service.h"

namespace uplink::relay {
namespace {

/// Cores that this process may use, which may be fewer than the machine has: two queues on one core
/// cost half as much again as one (measured).
std::size_t UsableCores() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  // More cores than the set has room for.
  if (sched_getaffinity(0, sizeof cores, &cores) != 0) {
    return std::max(1U, std::thread::hardware_concurrency());
  }
  return std::max<std::size_t>(1, static_cast<std::size_t>(CPU_COUNT(&cores)));
}

}  // namespace

/// Members are destroyed from the last: the server before its queues and service.
struct RelayServer::Impl {
  Impl(const RelayOptions& options, const RelayContext& given)
      : context(given), gate(options.streams_max, given.probe) {}

  const RelayContext context;
  /// None with texts in place of files.
  std::unique_ptr<ServedFiles> files;
  Gate gate;
  RelayService service;
  std::vector<std::unique_ptr<Queue>> queues;
  std::unique_ptr<grpc::Server> server;
  int port = 0;
};

absl::StatusOr<std::unique_ptr<RelayServer>> RelayServer::Start(const RelayOptions& options,
                                                                const RelayContext& context) {
  auto impl = std::make_unique<Impl>(options, context);
  KeyMaterial material = options.key_material;
  if (const auto* files = std::get_if<PemFiles>(&material)) {
    auto served = ServedFiles::Make(*files);
    if (!served.ok()) return served.status();
    impl->files = *std::move(served);
    material = impl->files->paths();
  }
  auto credentials = MutualTls(material);
  if (!credentials.ok()) return credentials.status();
  if (absl::Status status = CheckListenable(options.address); !status.ok()) return status;

  grpc::ServerBuilder builder;
  SetChannelArguments(options, context.limits, builder);
  builder.AddListeningPort(config::ToText(options.address), *credentials, &impl->port);
  builder.RegisterService(&impl->service);
  const std::size_t queues = options.queues > 0 ? options.queues : UsableCores();
  for (std::size_t i = 0; i < queues; ++i) {
    impl->queues.push_back(std::make_unique<Queue>(i, builder.AddCompletionQueue(), impl->service,
                                                   impl->gate, impl->context));
  }
  impl->server = builder.BuildAndStart();
  if (impl->server == nullptr || impl->port == 0) {
    if (impl->server != nullptr) impl->server->Shutdown();
    return absl::UnavailableError(
        fmt::format("cannot listen on {}: gRPC failed to", config::ToText(options.address)));
  }
  for (const auto& queue : impl->queues) queue->Start();
  return std::unique_ptr<RelayServer>(new RelayServer(std::move(impl)));
}

RelayServer::RelayServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

RelayServer::~RelayServer() { Shutdown(milliseconds(0)); }

std::uint16_t RelayServer::port() const { return static_cast<std::uint16_t>(impl_->port); }

std::size_t RelayServer::streams() const { return impl_->gate.streams(); }

bool RelayServer::draining() const { return impl_->gate.closed(); }

FilesLook RelayServer::RefreshFiles() {
  if (impl_->files == nullptr) return {};
  absl::Status status = impl_->files->Refresh();
  return {std::move(status), impl_->files->expiry()};
}

void RelayServer::Drain(milliseconds grace) {
  if (impl_->gate.closed()) return;
  impl_->gate.Close();
  for (const auto& queue : impl_->queues) queue->Drain(grace);
}

bool RelayServer::WaitForStreams(milliseconds wait) const { return impl_->gate.WaitEmpty(wait); }

void RelayServer::Shutdown(milliseconds wait) {
  impl_->gate.Close();
  impl_->server->Shutdown(
      gpr_time_add(gpr_now(GPR_CLOCK_MONOTONIC), gpr_time_from_millis(wait.count(), GPR_TIMESPAN)));
  // Every call has been cut or is over; its tags return on the queues, which then close.
  for (const auto& queue : impl_->queues) queue->Close();
}

}  // namespace uplink::relay
