#include "server/relay/server.h"

#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include "server/relay/channel_arguments.h"
#include "server/relay/credentials.h"
#include "server/relay/queue.h"
#include "server/relay/served_files.h"
#include "server/relay/service.h"
#include "server/transport/cores.h"
#include "server/transport/gate.h"
#include "server/transport/listenable.h"

namespace uplink::relay {
/// Members are destroyed from the last: the server before its queues and service.
struct RelayServer::Impl {
  Impl(const transport::RelayOptions& options, const transport::RelayContext& given)
      : context(given),
        gate({.streams_max = options.streams_max,
              .gateway_streams_max = options.gateway_streams_max},
             given.probe) {}

  const transport::RelayContext context;
  /// None with texts in place of files.
  std::unique_ptr<ServedFiles> files;
  transport::Gate gate;
  RelayService service;
  std::vector<std::unique_ptr<Queue>> queues;
  std::unique_ptr<grpc::Server> server;
  int port = 0;
};

absl::StatusOr<std::unique_ptr<RelayServer>> RelayServer::Start(
    const transport::RelayOptions& options, const transport::RelayContext& context) {
  auto impl = std::make_unique<Impl>(options, context);
  transport::KeyMaterial material = options.key_material;
  if (const auto* files = std::get_if<transport::PemFiles>(&material)) {
    auto served = ServedFiles::Make(*files);
    if (!served.ok()) return served.status();
    impl->files = *std::move(served);
    material = impl->files->paths();
  }
  auto credentials = MutualTls(material);
  if (!credentials.ok()) return credentials.status();
  if (absl::Status status = transport::CheckListenable(options.address); !status.ok())
    return status;

  grpc::ServerBuilder builder;
  SetChannelArguments(options, context.limits, builder);
  builder.AddListeningPort(config::ToText(options.address), *credentials, &impl->port);
  builder.RegisterService(&impl->service);
  const std::size_t queues = options.queues > 0 ? options.queues : transport::UsableCores();
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

transport::FilesLook RelayServer::RefreshFiles() {
  if (impl_->files == nullptr) return {};
  absl::Status status = impl_->files->Refresh();
  return {std::move(status), impl_->files->served()};
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
