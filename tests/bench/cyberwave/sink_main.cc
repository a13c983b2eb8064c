// A subscriber on libmosquitto that only counts: what a message costs at least. It acks
// at QoS 1 at once, as that library does.
#include <cstdio>
#include <cstdlib>
#include <string>

#include <mosquitto.h>
#include <mqtt_protocol.h>

#include "schema/cyberwave/topic_kinds.h"
#include "tests/bench/cyberwave/sink_count.h"

namespace uplink::bench {
namespace {

constexpr int kQos0 = 0;
constexpr int kQos1 = 1;
constexpr int kKeepaliveSeconds = 60;
/// As mqtt.unacked_max.
constexpr int kUnackedMax = 1'024;

struct Sink {
  SinkCount count;
  /// Filters that the broker has not answered yet.
  int unanswered = 0;
};

/// All that uplinkd reads of durable and live messages, on one connection.
void Subscribe(mosquitto* client, Sink& sink) {
  using cyberwave::Connection;
  for (const Connection connection : {Connection::kDurable, Connection::kLive}) {
    const int qos = connection == Connection::kDurable ? kQos1 : kQos0;
    for (const std::string& filter : cyberwave::Filters("", connection)) {
      ++sink.unanswered;
      mosquitto_subscribe_v5(client, nullptr, filter.c_str(), qos, 0, nullptr);
    }
  }
}

int Run(std::uint16_t port, const std::string& count_path) {
  Sink sink{.count = SinkCount(count_path)};
  mosquitto_lib_init();
  mosquitto* client = mosquitto_new("sink", true, &sink);
  if (client == nullptr) return EXIT_FAILURE;
  mosquitto_int_option(client, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5);
  mosquitto_int_option(client, MOSQ_OPT_RECEIVE_MAXIMUM, kUnackedMax);
  mosquitto_connect_v5_callback_set(client,
                                    [](mosquitto* connected, void* of_sink, int code, int /*flags*/,
                                       const mosquitto_property* /*properties*/) {
                                      if (code == 0)
                                        Subscribe(connected, *static_cast<Sink*>(of_sink));
                                    });
  mosquitto_subscribe_callback_set(client, [](mosquitto* /*client*/, void* of_sink, int /*id*/,
                                              int /*filters*/, const int* /*granted*/) {
    if (--static_cast<Sink*>(of_sink)->unanswered > 0) return;
    std::puts(kSinkReady);
    std::fflush(stdout);
  });
  mosquitto_message_v5_callback_set(
      client,
      [](mosquitto* /*client*/, void* of_sink, const mosquitto_message* /*message*/,
         const mosquitto_property* /*properties*/) { static_cast<Sink*>(of_sink)->count.Add(); });
  if (mosquitto_connect(client, "127.0.0.1", port, kKeepaliveSeconds) != MOSQ_ERR_SUCCESS) {
    return EXIT_FAILURE;
  }
  mosquitto_loop_forever(client, -1, 1);
  return EXIT_FAILURE;
}

}  // namespace
}  // namespace uplink::bench

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: uplink_bench_mqtt_sink PORT COUNT_FILE\n");
    return 2;
  }
  return uplink::bench::Run(static_cast<std::uint16_t>(std::strtoul(argv[1], nullptr, 10)),
                            argv[2]);
}
