#include "server/front/server.h"

#include <algorithm>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <sched.h>
#include <sys/resource.h>

#include "server/front/call/relay_handler.h"
#include "server/front/door/acceptor.h"
#include "server/front/door/door.h"
#include "server/front/door/origin_reader.h"
#include "server/front/tls/tls_context.h"
#include "server/front/worker.h"
#include "server/log/rate_limited.h"
#include "server/transport/descriptors.h"
#include "server/transport/gate.h"
#include "server/transport/key_files.h"

namespace uplink::front {
namespace {

/// The usual number of descriptors, if the system does not say how many we may have.
constexpr std::size_t kDescriptorsDefault = 1024;

/// Lines about the acceptor's pauses per span of RateLimited.
constexpr std::uint32_t kPauseLinesMax = 1;

/// Cores that this process may use, which may be fewer than the machine's: two threads of streams
/// on one core cost half as much again as one (measured). At least one.
std::size_t UsableCores() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  // More cores than the set has room for.
  if (sched_getaffinity(0, sizeof cores, &cores) != 0) {
    return std::max(1U, std::thread::hardware_concurrency());
  }
  return std::max<std::size_t>(1, static_cast<std::size_t>(CPU_COUNT(&cores)));
}

/// Descriptors that the listener may have.
std::size_t DescriptorsMax(const transport::RelayOptions& options) {
  if (options.descriptors_max > 0) return options.descriptors_max;
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return kDescriptorsDefault;
  return static_cast<std::size_t>(limit.rlim_cur);
}

}  // namespace

/// Members are destroyed from the last.
struct FrontServer::Impl {
  Impl(const transport::RelayOptions& given_options, const RelayContext& given,
       transport::MethodsMaker others)
      : options(given_options),
        context(given),
        make_methods(
            [others = std::move(others), relay = given_options.serves_relay](const Clock& clock) {
              transport::Methods methods = others ? others(clock) : transport::Methods();
              if (relay) methods.merge(RelayHandler::Served());
              return methods;
            }),
        limits(DoorLimitsFor({.streams_max = given_options.streams_max,
                              .descriptors_max = DescriptorsMax(given_options),
                              .reserved = given_options.descriptors_reserved,
                              .headers = given_options.proxy_protocol_from.empty()
                                             ? ProxyHeaders::kNone
                                             : ProxyHeaders::kExpected})),
        gate({.streams_max = given_options.streams_max,
              .gateway_streams_max = given_options.gateway_streams_max},
             given.probe),
        book(limits.book, given.probe, given.logger),
        unfinished(
            UnfinishedLimitsFor(given_options.memory_bytes_max, given.limits.frame_bytes_max),
            given.probe) {
    if (given.logger != nullptr) pause_lines.emplace(*given.logger, kPauseLinesMax);
  }

  absl::Status ServeFiles();
  absl::Status Serve(const transport::PemTexts& texts);
  /// Shows the bound of connections, and warns if the descriptors do not reach for all bounds.
  void TellLimits() const;
  void StartWorkers();
  void OpenDoor();
  /// Admits no more connections, and turns waiting ones away.
  void CloseDoor();
  [[nodiscard]] Worker& LeastLoaded();
  /// Accepting pauses for a moment: counts it, and logs it now and then.
  void NotePause(std::error_code why);

  const transport::RelayOptions options;
  const RelayContext context;
  std::optional<log::RateLimited> pause_lines;
  const transport::MethodsMaker make_methods;
  /// None with texts in place of files.
  std::unique_ptr<transport::KeyFiles> files;
  /// Whether the last texts of the files could be served.
  absl::Status served;
  ServedContext tls;
  const DoorLimits limits;
  transport::Gate gate;
  DoorBook book;
  Unfinished unfinished;
  std::vector<std::unique_ptr<Worker>> workers;
  std::unique_ptr<Acceptor> acceptor;
  /// Both are used on the acceptor's thread.
  std::unique_ptr<Door> door;
  std::unique_ptr<OriginReader> origin_reader;
};

absl::Status FrontServer::Impl::Serve(const transport::PemTexts& texts) {
  auto made = TlsContext::Make(texts, options.tls);
  if (!made.ok()) return made.status();
  const std::shared_ptr<const TlsContext> before = tls.get();
  const bool changes = before != nullptr && before->trusted() != (*made)->trusted();
  tls.Set(*std::move(made));
  if (!changes) return absl::OkStatus();
  for (const auto& worker : workers) worker->LookAtAuthorities();
  return absl::OkStatus();
}

absl::Status FrontServer::Impl::ServeFiles() {
  const auto fresh = files->Refresh();
  if (!fresh.ok()) return fresh.status();
  // The same texts have the same result as before.
  if (*fresh) served = Serve(files->texts());
  return served;
}

absl::StatusOr<std::unique_ptr<FrontServer>> FrontServer::Start(
    const transport::RelayOptions& options, const RelayContext& context,
    transport::MethodsMaker others) {
  auto impl = std::make_unique<Impl>(options, context, std::move(others));
  absl::Status served;
  if (const auto* files = std::get_if<transport::PemFiles>(&options.key_material)) {
    impl->files = std::make_unique<transport::KeyFiles>(*files);
    served = impl->ServeFiles();
  } else {
    served = impl->Serve(std::get<transport::PemTexts>(options.key_material));
  }
  if (!served.ok()) return served;
  auto acceptor = Acceptor::Listen(options.address);
  if (!acceptor.ok()) return acceptor.status();
  impl->acceptor = *std::move(acceptor);

  impl->TellLimits();
  impl->StartWorkers();
  impl->OpenDoor();
  return std::unique_ptr<FrontServer>(new FrontServer(std::move(impl)));
}

void FrontServer::Impl::TellLimits() const {
  const std::size_t connections = limits.book.connections_max;
  context.probe.connections_limit.Set(static_cast<std::int64_t>(connections));
  const std::size_t wanted = transport::DescriptorsWanted(options);
  // One with its own part of them takes what it gets.
  if (options.descriptors_max > 0 || context.logger == nullptr) return;
  const std::size_t descriptors_max = DescriptorsMax(options);
  if (descriptors_max >= wanted) return;
  context.logger->Warn("descriptors_few", {{"descriptors_max", descriptors_max},
                                           {"descriptors_wanted", wanted},
                                           {"connections_limit", connections},
                                           {"connections_wanted", options.streams_max}});
}

void FrontServer::Impl::StartWorkers() {
  const std::size_t count = options.queues > 0 ? options.queues : UsableCores();
  for (std::size_t i = 0; i < count; ++i) {
    Worker::Setup setup{
        .name = options.name,
        .index = i,
        .connection_age_max = options.connection_age_max,
        .gateway_streams_max = static_cast<std::uint32_t>(options.gateway_streams_max)};
    setup.handshake_began = [this](std::uint64_t id) {
      acceptor->Post([this, id] { door->HandshakeBegan(id, context.clock.Steady()); });
    };
    setup.handshake_ended = [this](std::uint64_t id) {
      acceptor->Post([this, id] { door->HandshakeEnded(id, context.clock.Steady()); });
    };
    setup.evict = [this](std::uint64_t id) {
      // Ask all workers which one has it: this is rare.
      for (const auto& worker : workers) worker->Evict(id);
    };
    workers.push_back(
        std::make_unique<Worker>(setup, context, gate, make_methods, tls, book, unfinished));
  }
  for (const auto& worker : workers) worker->Start();
}

Worker& FrontServer::Impl::LeastLoaded() {
  return **std::min_element(workers.begin(), workers.end(),
                            [](const auto& a, const auto& b) { return a->load() < b->load(); });
}

void FrontServer::Impl::OpenDoor() {
  door = std::make_unique<Door>(
      limits.handshakes, book, context.probe,
      Door::Actions{.admit =
                        [this](std::uint64_t id, IncomingConnection incoming) {
                          LeastLoaded().Adopt(id, std::move(incoming));
                        },
                    .cut =
                        [this](std::uint64_t id) {
                          for (const auto& worker : workers) worker->CutHandshake(id);
                        }});
  origin_reader = std::make_unique<OriginReader>(
      acceptor->context(), book, context.probe, context.clock,
      OriginReader::Setup{.load_balancers = options.proxy_protocol_from,
                          .waiting_max = limits.proxy_headers_max,
                          .hand = [this](IncomingConnection incoming) {
                            door->Arrive(std::move(incoming), context.clock.Steady());
                          }});
  acceptor->Start([this](Accepted accepted) { origin_reader->Arrive(std::move(accepted)); },
                  {.tick =
                       [this] {
                         origin_reader->Tick();
                         door->Tick(context.clock.Steady());
                       },
                   .paused = [this](std::error_code why) { NotePause(why); }});
}

void FrontServer::Impl::NotePause(std::error_code why) {
  context.probe.accept_pauses_total.Add();
  if (pause_lines) pause_lines->Write(log::Level::kWarn, "accept_paused", {{"why", why.message()}});
}

void FrontServer::Impl::CloseDoor() {
  acceptor->Stop();
  // Work that workers still post does not run.
  origin_reader.reset();
  door.reset();
}

FrontServer::FrontServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

FrontServer::~FrontServer() { Shutdown(); }

std::uint16_t FrontServer::port() const { return impl_->acceptor->port(); }

std::size_t FrontServer::streams() const { return impl_->gate.streams(); }

bool FrontServer::draining() const { return impl_->gate.closed(); }

transport::FilesLook FrontServer::RefreshFiles() {
  if (impl_->files == nullptr) return {};
  absl::Status status = impl_->ServeFiles();
  return {std::move(status), impl_->files->served()};
}

void FrontServer::LookAtDenied() {
  for (const auto& worker : impl_->workers) worker->LookAtDenied();
}

void FrontServer::Drain(milliseconds grace) {
  if (impl_->gate.closed()) return;
  impl_->gate.Close();
  impl_->CloseDoor();
  for (const auto& worker : impl_->workers) worker->Drain(grace);
}

bool FrontServer::WaitForStreams(milliseconds wait) const { return impl_->gate.WaitEmpty(wait); }

void FrontServer::Shutdown() {
  impl_->gate.Close();
  impl_->CloseDoor();
  for (const auto& worker : impl_->workers) worker->Stop();
}

}  // namespace uplink::front
