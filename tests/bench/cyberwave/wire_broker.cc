#include "tests/bench/cyberwave/wire_broker.h"

#include <array>
#include <chrono>

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "schema/base/check.h"
#include "tests/bench/load/mqtt.h"

namespace uplink::bench {
namespace {

constexpr auto kPingreq = static_cast<char>(0xC0);
constexpr auto kPingresp = static_cast<char>(0xD0);
constexpr auto kDisconnect = static_cast<char>(0xE0);
constexpr milliseconds kPatience{20'000};
constexpr milliseconds kLook{5};
constexpr std::size_t kReadBytes = 4'096;
constexpr int kBacklog = 8;
constexpr std::size_t kNumberBytes = 2;
constexpr unsigned kByteBits = 8;

std::uint16_t NumberAt(std::string_view in, std::size_t at) {
  UPLINK_CHECK(at + kNumberBytes <= in.size(), "a packet holds its fields");
  return static_cast<std::uint16_t>(static_cast<unsigned>(static_cast<unsigned char>(in[at]))
                                        << kByteBits |
                                    static_cast<unsigned char>(in[at + 1]));
}

std::string Packet(char head, std::string_view body) {
  std::string packet(1, head);
  AppendMqttLength(packet, body.size());
  return packet.append(body);
}

void SendAll(int socket, std::string_view bytes) {
  UPLINK_CHECK(
      send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size()),
      "the subscriber takes a packet");
}

/// SUBACK's body: each filter at the QoS that was asked for.
std::string Granted(std::string_view asked) {
  // Packet id; properties, which a SUBSCRIBE of a subscriber like this has none of, or few.
  std::string granted(asked.substr(0, kNumberBytes));
  granted += '\0';
  std::size_t at = kNumberBytes + 1 + static_cast<unsigned char>(asked[kNumberBytes]);
  while (at < asked.size()) {
    at += kNumberBytes + NumberAt(asked, at);
    UPLINK_CHECK(at < asked.size(), "a filter has its options");
    granted += static_cast<char>(static_cast<unsigned char>(asked[at]) & 0x03U);
    ++at;
  }
  return granted;
}

}  // namespace

WireBroker::WireBroker(const Clock& clock)
    : clock_(clock), listener_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  UPLINK_CHECK(bind(listener_, generic, size) == 0 && listen(listener_, kBacklog) == 0 &&
                   getsockname(listener_, generic, &size) == 0,
               "a benchmark can listen");
  port_ = ntohs(address.sin_port);
}

WireBroker::~WireBroker() {
  for (const Connection& each : connections_) close(each.socket);
  close(listener_);
}

void WireBroker::WaitFor(std::string_view filter) {
  const SteadyTime end = clock_.Steady() + kPatience;
  while (clock_.Steady() < end) {
    Work(kLook);
    for (std::size_t i = 0; i < connections_.size(); ++i) {
      if (connections_[i].asked.find(filter) == std::string::npos) continue;
      durable_ = i;
      return;
    }
  }
  UPLINK_CHECK(false, "the subscriber asks for durable messages");
}

double WireBroker::Publish(std::string_view topic, std::string_view payload) {
  std::string body;
  AppendMqttText(body, topic);
  if (++last_id_ == 0) last_id_ = 1;
  AppendMqttNumber(body, last_id_);
  body += '\0';
  body.append(payload);
  const std::string packet = Packet(kMqttPublishQos1, body);
  const SteadyTime began = clock_.Steady();
  SendAll(connections_[durable_].socket, packet);
  while (connections_[durable_].acked != last_id_) {
    UPLINK_CHECK(clock_.Steady() < began + kPatience, "a PUBLISH is acked");
    Work(kLook);
  }
  const std::chrono::duration<double, std::milli> took = clock_.Steady() - began;
  return took.count();
}

void WireBroker::Rest(milliseconds duration) {
  const SteadyTime end = clock_.Steady() + duration;
  for (SteadyTime now = clock_.Steady(); now < end; now = clock_.Steady()) {
    Work(std::chrono::ceil<milliseconds>(end - now));
  }
}

void WireBroker::Work(milliseconds wait_max) {
  std::vector<pollfd> polled{{.fd = listener_, .events = POLLIN, .revents = 0}};
  for (const Connection& each : connections_) {
    polled.push_back({.fd = each.socket, .events = POLLIN, .revents = 0});
  }
  if (poll(polled.data(), polled.size(), static_cast<int>(wait_max.count())) <= 0) return;
  for (std::size_t i = 1; i < polled.size(); ++i) {
    if (polled[i].revents != 0) Read(connections_[i - 1]);
  }
  if (polled[0].revents != 0) Accept();
}

void WireBroker::Accept() {
  Connection connection{.socket = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC)};
  UPLINK_CHECK(connection.socket >= 0, "a broker takes a connection");
  const int yes = 1;
  setsockopt(connection.socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
  connections_.push_back(std::move(connection));
}

void WireBroker::Read(Connection& connection) {
  std::array<char, kReadBytes> bytes;  // NOLINT(*-member-init): the system's to fill
  const ssize_t count = recv(connection.socket, bytes.data(), bytes.size(), 0);
  UPLINK_CHECK(count > 0, "the subscriber stays");
  connection.in.append(bytes.data(), static_cast<std::size_t>(count));
  std::string_view rest = connection.in;
  MqttPacket packet = ReadMqttPacket(rest);
  for (; packet.state == MqttPacket::State::kWhole; packet = ReadMqttPacket(rest)) {
    Answer(connection, packet.head, packet.body);
    rest.remove_prefix(packet.bytes);
  }
  connection.in.erase(0, connection.in.size() - rest.size());
}

void WireBroker::Answer(Connection& connection, char head, std::string_view body) {
  // No session, a code of 0, no properties.
  if (head == kMqttConnect) return SendAll(connection.socket, {"\x20\3\0\0\0", 5});
  if (head == kPingreq) return SendAll(connection.socket, Packet(kPingresp, ""));
  if (head == kMqttSubscribe) {
    connection.asked.append(body);
    return SendAll(connection.socket, Packet(kMqttSuback, Granted(body)));
  }
  if (head == kMqttPuback) connection.acked = NumberAt(body, 0);
  UPLINK_CHECK(head == kMqttPuback || head == kDisconnect, "a subscriber says nothing else");
}

}  // namespace uplink::bench
