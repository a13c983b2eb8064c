#include "tests/bench/cyberwave/subscribers.h"

#include <filesystem>
#include <fstream>
#include <string_view>

#include <fmt/core.h>

#include "schema/base/check.h"
#include "tests/bench/pinned_server.h"
#include "tests/support/eventually.h"
#include "tests/support/raw_http.h"
#include "tests/support/raw_tcp.h"

namespace uplink::bench {
namespace {

constexpr const char* kExporter = "/usr/bin/prometheus-mqtt-exporter";
constexpr int kJoints = 6;

/// A program in Go sends a long page in pieces, but not to a client of HTTP/1.0.
Samples PageOf(std::uint16_t port) {
  testing::RawTcp tcp(port);
  const SteadyTime deadline = SystemClock{}.Steady() + testing::kPatience;
  constexpr std::string_view kGet = "GET /metrics HTTP/1.0\r\n\r\n";
  UPLINK_CHECK(tcp.SendSome(kGet) == kGet.size(), "a request leaves");
  std::string page;
  while (tcp.end() == testing::RawTcp::End::kNone) {
    UPLINK_CHECK(tcp.Wait(testing::RawTcp::For::kInput, deadline), "a page comes");
    page += tcp.Receive();
  }
  return SamplesOf(page);
}

std::string ExporterConfig(std::uint16_t broker_port) {
  std::string text = fmt::format(
      "mqtt:\n  server: tcp://127.0.0.1:{}\n  topic_path: cyberwave/joint/+/update\n"
      "  device_id_regex: \"cyberwave/joint/(?P<deviceid>[^/]+)/update\"\n  qos: 0\n"
      "cache:\n  timeout: 60m\nmetrics:\n",
      broker_port);
  for (int joint = 1; joint <= kJoints; ++joint) {
    text += fmt::format(
        "  - prom_name: joint_{0}\n    mqtt_name: \"_{0}\"\n    help: a joint\n    type: gauge\n",
        joint);
  }
  return text;
}

}  // namespace

Sink::Sink(std::uint16_t broker_port)
    : process_(
          StartPinned({MQTT_SINK_PROGRAM, std::to_string(broker_port), folder_.File("count")})) {
  UPLINK_CHECK(process_->WaitFor(kSinkReady), process_->text());
}

Exporter::Exporter(std::uint16_t broker_port) : port_(testing::FreePort()) {
  std::ofstream(folder_.File("config.yaml")) << ExporterConfig(broker_port);
  process_ =
      StartPinned({kExporter, "-config", folder_.File("config.yaml"), "-listen-address",
                   "127.0.0.1", "-listen-port", std::to_string(port_), "-log-level", "error"});
  UPLINK_CHECK(process_->WaitFor("Listening on"), process_->text());
  const bool connected = testing::Eventually(
      [this] { return FigureOf(PageOf(port_), "mqtt2prometheus_connected") == 1; });
  UPLINK_CHECK(connected, "the exporter connects");
}

bool Exporter::IsInstalled() { return std::filesystem::exists(kExporter); }

std::uint64_t Exporter::count() {
  return static_cast<std::uint64_t>(SumOf(PageOf(port_), "received_messages{"));
}

Uplinkd::Uplinkd(const Options& options) : counts_media_(options.media == "count") {
  folder_.WriteConfig(
      fmt::format("[mqtt]\nurl = \"mqtt://127.0.0.1:{}\"\n[cyberwave]\nmedia = \"{}\"\n",
                  options.broker_port, options.media));
  std::vector<std::string> environment;
  if (!options.store_url.empty()) environment.push_back("UPLINKD_STORE_URL=" + options.store_url);
  auto server =
      PinnedServer::Start(folder_, {.program = UPLINKD_PROGRAM, .environment = environment});
  UPLINK_CHECK(server.ok(), server.status().ToString());
  server_ = *std::move(server);
}

std::uint64_t Uplinkd::count() {
  return static_cast<std::uint64_t>(SumOf(Metrics(), "uplinkd_mqtt_messages_settled_total{"));
}

Samples Uplinkd::Metrics() const {
  return SamplesOf(testing::HttpGet(server_->ports().http, "/metrics").body);
}

void Uplinkd::WaitConnected() const {
  const double connections = counts_media_ ? 3 : 2;
  const bool connected = testing::Eventually(
      [&] { return SumOf(Metrics(), "uplinkd_mqtt_connected{") == connections; });
  UPLINK_CHECK(connected, "uplinkd reaches the broker: " + server_->log());
}

}  // namespace uplink::bench
