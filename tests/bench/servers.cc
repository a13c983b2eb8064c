#include "tests/bench/servers.h"

#include <csignal>
#include <filesystem>
#include <utility>

#include <fmt/core.h>

#include "schema/base/check.h"
#include "tests/bench/pinned_server.h"
#include "tests/support/eventually.h"
#include "tests/support/raw_tcp.h"

namespace uplink::bench {
namespace {

constexpr const char* kMosquitto = "/usr/sbin/mosquitto";
constexpr const char* kNats = "/usr/sbin/nats-server";

std::string MosquittoConfig(const testing::UplinkdFolder& folder, std::uint16_t port) {
  return fmt::format(
      "user root\npersistence false\nlog_type error\nset_tcp_nodelay true\n"
      "listener {} 127.0.0.1\nallow_anonymous true\nrequire_certificate true\n"
      "cafile {}\ncertfile {}\nkeyfile {}\n",
      port, folder.Path("ca.crt"), folder.Path("server.crt"), folder.Path("server.key"));
}

Protocol ProtocolOf(ServerKind kind) {
  switch (kind) {
    case ServerKind::kUplinkd:
    case ServerKind::kGrpcSink:
      return Protocol::kRelay;
    case ServerKind::kTlsSink:
      return Protocol::kLengthPrefix;
    case ServerKind::kMosquitto:
      return Protocol::kMqtt;
    case ServerKind::kMosquittoQos0:
      return Protocol::kMqttQos0;
    case ServerKind::kNats:
      return Protocol::kNats;
  }
  return Protocol::kRelay;
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

Server::Server(const World& world, ServerKind kind, std::size_t frame_messages,
               std::vector<std::string> environment)
    : world_(world),
      kind_(kind),
      frame_messages_(frame_messages),
      environment_(std::move(environment)),
      port_(testing::FreePort()) {
  // A port may come again, and with it a store's name.
  for (const char* end : {"", "-wal", "-shm"}) {
    std::filesystem::remove(world.folder.Path(fmt::format("uplinkd-{}.db{}", port_, end)));
  }
  Start();
}

void Server::Start() {
  const testing::UplinkdFolder& folder = world_.folder;
  if (kind_ == ServerKind::kUplinkd) {
    // Every server has a store of its own, and keeps it when it is started again. Robots that rest
    // while another server is measured are not offline.
    std::vector<std::string> environment = environment_;
    environment.insert(
        environment.end(),
        {fmt::format("UPLINKD_LISTEN_RELAY=127.0.0.1:{}", port_),
         fmt::format("UPLINKD_STORE_URL=sqlite://{}",
                     folder.Path(fmt::format("uplinkd-{}.db", port_))),
         "UPLINKD_PRESENCE_TIMEOUT=1h", "UPLINKD_RATES_OBJECT=0", "UPLINKD_RATES_TELEMETRY=0"});
    process_ = StartPinned({UPLINKD_PROGRAM, "--config", folder.Path("uplinkd.toml")}, environment);
    UPLINK_CHECK(testing::WaitForPorts(*process_).has_value(), process_->text());
    return;
  }
  process_ = StartPinned(Command());
  const auto answers = [this] {
    return testing::RawTcp(port_).end() == testing::RawTcp::End::kNone;
  };
  if (testing::Eventually(answers)) return;
  process_->Signal(SIGTERM);
  static_cast<void>(process_->WaitForExit());
  UPLINK_CHECK(false, NameOf(kind_) + " listens: " + process_->text());
}

std::vector<std::string> Server::Command() const {
  const testing::UplinkdFolder& folder = world_.folder;
  const std::string port = std::to_string(port_);
  switch (kind_) {
    case ServerKind::kUplinkd:
      break;
    case ServerKind::kGrpcSink:
      return {GRPC_SINK_PROGRAM, folder.Path(""), port, std::to_string(frame_messages_)};
    case ServerKind::kTlsSink:
      return {TLS_SINK_PROGRAM, folder.Path(""), port};
    case ServerKind::kMosquitto:
    case ServerKind::kMosquittoQos0:
      folder.Write("mosquitto.conf", MosquittoConfig(folder, port_));
      return {kMosquitto, "-c", folder.Path("mosquitto.conf")};
    case ServerKind::kNats:
      return {kNats,
              "-a",
              "127.0.0.1",
              "-p",
              port,
              "--tls",
              "--tlsverify",
              "--tlscert",
              folder.Path("server.crt"),
              "--tlskey",
              folder.Path("server.key"),
              "--tlscacert",
              folder.Path("ca.crt")};
  }
  return {};
}

Load::Where Server::where() const {
  Load::Where where;
  where.protocol = ProtocolOf(kind_);
  const bool http2 = where.protocol == Protocol::kRelay;
  where.link = world_.LinkTo(port_, http2 ? link::Alpn::kHttp2 : link::Alpn::kNone);
  // What a flood says is one message a record, also where HTTP/2's window made some wait.
  where.link.record_per_message = true;
  where.identities = &world_.identities;
  return where;
}

void Server::KillAndStart() {
  process_->Signal(SIGKILL);
  UPLINK_CHECK(process_->WaitForExit().has_value(), "a killed process ends");
  Start();
}

}  // namespace uplink::bench
