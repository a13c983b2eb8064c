#include "tests/bench/servers.h"

#include <csignal>
#include <filesystem>

#include <fmt/core.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "schema/base/check.h"
#include "tests/bench/free_port.h"
#include "tests/support/eventually.h"

namespace uplink::bench {
namespace {

constexpr const char* kMosquitto = "/usr/sbin/mosquitto";
constexpr const char* kNats = "/usr/sbin/nats-server";

bool Answers(std::uint16_t port) {
  const int descriptor = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  const bool answers =
      connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  close(descriptor);
  return answers;
}

std::string MosquittoConfig(const testing::UplinkdFolder& folder, std::uint16_t port) {
  return fmt::format(
      "user root\npersistence false\nlog_type error\nset_tcp_nodelay true\n"
      "listener {} 127.0.0.1\nallow_anonymous true\nrequire_certificate true\n"
      "cafile {}\ncertfile {}\nkeyfile {}\n",
      port, folder.Path("ca.crt"), folder.Path("server.crt"), folder.Path("server.key"));
}

}  // namespace

std::string NameOf(ServerKind kind) {
  switch (kind) {
    case ServerKind::kUplinkd:
      return "uplinkd";
    case ServerKind::kGrpcSink:
      return "bare gRPC sink";
    case ServerKind::kTlsSink:
      return "bare TLS sink";
    case ServerKind::kMosquitto:
      return "mosquitto QoS 1";
    case ServerKind::kMosquittoQos0:
      return "mosquitto QoS 0";
    case ServerKind::kNats:
      return "nats-server";
  }
  return "";
}

bool IsInstalled(ServerKind kind) {
  if (kind == ServerKind::kMosquitto || kind == ServerKind::kMosquittoQos0) {
    return std::filesystem::exists(kMosquitto);
  }
  if (kind == ServerKind::kNats) return std::filesystem::exists(kNats);
  return true;
}

Server::Server(const World& world, ServerKind kind, std::size_t frame_messages)
    : world_(world),
      kind_(kind),
      frame_messages_(frame_messages),
      folder_(world.folder.Path("")),
      port_(FreePort()) {
  // A port may come again, and with it a store's name.
  for (const char* end : {"", "-wal", "-shm"}) {
    std::filesystem::remove(world.folder.Path(fmt::format("uplinkd-{}.db{}", port_, end)));
  }
  Start();
}

void Server::Start() {
  const testing::UplinkdFolder& folder = world_.folder;
  // What is started takes the core of who starts it.
  PinTo(kServerCore);
  switch (kind_) {
    case ServerKind::kUplinkd:
      // Every server has a store of its own, and keeps it when it is started again. Robots that
      // rest while another server is measured are not offline.
      process_ = folder.Start({}, {fmt::format("UPLINKD_LISTEN_RELAY=127.0.0.1:{}", port_),
                                   fmt::format("UPLINKD_STORE_URL=sqlite://{}",
                                               folder.Path(fmt::format("uplinkd-{}.db", port_))),
                                   "UPLINKD_PRESENCE_TIMEOUT=1h", "UPLINKD_RATES_OBJECT=0",
                                   "UPLINKD_RATES_TELEMETRY=0"});
      break;
    case ServerKind::kGrpcSink:
      process_ = std::make_unique<testing::ServerProcess>(std::vector<std::string>{
          GRPC_SINK_PROGRAM, folder_, std::to_string(port_), std::to_string(frame_messages_)});
      break;
    case ServerKind::kTlsSink:
      process_ = std::make_unique<testing::ServerProcess>(
          std::vector<std::string>{TLS_SINK_PROGRAM, folder_, std::to_string(port_)});
      break;
    case ServerKind::kMosquitto:
    case ServerKind::kMosquittoQos0:
      folder.Write("mosquitto.conf", MosquittoConfig(folder, port_));
      process_ = std::make_unique<testing::ServerProcess>(
          std::vector<std::string>{kMosquitto, "-c", folder.Path("mosquitto.conf")});
      break;
    case ServerKind::kNats:
      process_ = std::make_unique<testing::ServerProcess>(std::vector<std::string>{
          kNats, "-a", "127.0.0.1", "-p", std::to_string(port_), "--tls", "--tlsverify",
          "--tlscert", folder.Path("server.crt"), "--tlskey", folder.Path("server.key"),
          "--tlscacert", folder.Path("ca.crt")});
      break;
  }
  PinTo(kLoadCore);
  if (kind_ == ServerKind::kUplinkd) {
    UPLINK_CHECK(testing::WaitForPorts(*process_).has_value(), process_->text());
  } else {
    if (testing::Eventually([this] { return Answers(port_); })) return;
    process_->Signal(SIGTERM);
    static_cast<void>(process_->WaitForExit());
    UPLINK_CHECK(false, NameOf(kind_) + " listens: " + process_->text());
  }
}

Load::Where Server::where() const {
  Load::Where where;
  switch (kind_) {
    case ServerKind::kUplinkd:
    case ServerKind::kGrpcSink:
      where.protocol = Protocol::kRelay;
      break;
    case ServerKind::kTlsSink:
      where.protocol = Protocol::kLengthPrefix;
      break;
    case ServerKind::kMosquitto:
    case ServerKind::kMosquittoQos0:
      where.protocol = Protocol::kMqtt;
      break;
    case ServerKind::kNats:
      where.protocol = Protocol::kNats;
      break;
  }
  const bool http2 = where.protocol == Protocol::kRelay;
  where.link.tls = *link::TlsClient::Create(world_.folder.authority().certificate(),
                                            http2 ? link::Alpn::kHttp2 : link::Alpn::kNone);
  where.link.address = *link::Resolve("127.0.0.1:" + std::to_string(port_));
  // What a flood says is one message a record, also where HTTP/2's window made some wait.
  where.link.record_per_message = true;
  where.identities = &world_.identities;
  return where;
}

synthetic::ProcessUse Server::use() const {
  const auto use = synthetic::UseOf(process_->pid());
  UPLINK_CHECK(use.has_value(), NameOf(kind_) + " still runs");
  return *use;
}

void Server::KillAndStart() {
  process_->Signal(SIGKILL);
  UPLINK_CHECK(process_->WaitForExit().has_value(), "a killed process ends");
  Start();
}

}  // namespace uplink::bench
