#include "tests/bench/cyberwave/publishers.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "schema/base/check.h"
#include "tests/bench/load/mqtt.h"

namespace uplink::bench {
namespace {

constexpr milliseconds kTick{1};
constexpr milliseconds kLate{100};
constexpr std::size_t kReadBytes = std::size_t{16} * 1024;
constexpr std::size_t kConnackBytes = 4;
constexpr std::uint16_t kIdMax = 65'535;

bool WouldBlock() { return errno == EAGAIN || errno == EINTR; }

timespec TimespecOf(std::chrono::nanoseconds wait) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(wait);
  return {.tv_sec = seconds.count(), .tv_nsec = (wait - seconds).count()};
}

}  // namespace

Publishers::Publishers(std::uint16_t port, std::size_t connections,
                       std::vector<PublishPacket> packets, const Clock& clock)
    : clock_(clock), packets_(std::move(packets)), connections_(connections) {
  UPLINK_CHECK(packets_.size() % connections == 0, "a packet has its connection");
  for (std::size_t i = 0; i < connections_.size(); ++i) Connect(connections_[i], port, i);
}

Publishers::~Publishers() {
  for (const Connection& each : connections_) close(each.socket);
}

void Publishers::Connect(Connection& connection, std::uint16_t port, std::size_t number) const {
  connection.socket = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);
  UPLINK_CHECK(connect(connection.socket, generic, sizeof(address)) == 0, "a broker listens");
  const int yes = 1;
  setsockopt(connection.socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
  const std::string hello = MqttConnectPacket(fmt::format("publisher-{}", number));
  std::array<char, kConnackBytes> answer{};
  UPLINK_CHECK(send(connection.socket, hello.data(), hello.size(), MSG_NOSIGNAL) ==
                       static_cast<ssize_t>(hello.size()) &&
                   recv(connection.socket, answer.data(), answer.size(), MSG_WAITALL) ==
                       static_cast<ssize_t>(answer.size()) &&
                   answer[0] == kMqttConnack && answer[3] == 0,
               "the broker takes a publisher");
  fcntl(connection.socket, F_SETFL, O_NONBLOCK);
}

void Publishers::Put() {
  PublishPacket& packet = packets_[next_ % packets_.size()];
  Connection& connection = NextConnection();
  if (packet.id_at > 0) {
    connection.last_id = connection.last_id == kIdMax ? 1 : connection.last_id + 1;
    packet.SetId(connection.last_id);
    ++connection.unacked;
  }
  connection.out += packet.bytes;
  ++next_;
  ++sent_;
}

void Publishers::Write(Connection& connection) {
  std::size_t written = 0;
  while (written < connection.out.size()) {
    const ssize_t count = send(connection.socket, connection.out.data() + written,
                               connection.out.size() - written, MSG_NOSIGNAL);
    if (count < 0 && WouldBlock()) break;
    UPLINK_CHECK(count >= 0, "the broker takes packets");
    written += static_cast<std::size_t>(count);
  }
  connection.out.erase(0, written);
}

void Publishers::Read(Connection& connection) {
  std::array<char, kReadBytes> bytes;  // NOLINT(*-member-init): the system's to fill
  const ssize_t count = recv(connection.socket, bytes.data(), bytes.size(), 0);
  if (count < 0 && WouldBlock()) return;
  UPLINK_CHECK(count > 0, "the broker keeps its publishers");
  connection.in.append(bytes.data(), static_cast<std::size_t>(count));
  std::string_view rest = connection.in;
  MqttPacket packet = ReadMqttPacket(rest);
  for (; packet.state == MqttPacket::State::kWhole; packet = ReadMqttPacket(rest)) {
    if (packet.head == kMqttPuback) --connection.unacked;
    rest.remove_prefix(packet.bytes);
  }
  connection.in.erase(0, connection.in.size() - rest.size());
}

void Publishers::Work(std::chrono::nanoseconds wait_max) {
  std::vector<pollfd> polled;
  polled.reserve(connections_.size());
  for (Connection& each : connections_) {
    if (!each.out.empty()) Write(each);
    const auto events = static_cast<short>(each.out.empty() ? POLLIN : POLLIN | POLLOUT);
    polled.push_back({.fd = each.socket, .events = events, .revents = 0});
  }
  const timespec wait = TimespecOf(std::max(wait_max, std::chrono::nanoseconds(0)));
  if (ppoll(polled.data(), polled.size(), &wait, nullptr) <= 0) return;
  for (std::size_t i = 0; i < polled.size(); ++i) {
    if ((polled[i].revents & POLLIN) != 0) Read(connections_[i]);
    if ((polled[i].revents & POLLOUT) != 0) Write(connections_[i]);
  }
}

void Publishers::Pace(double per_second, milliseconds duration) {
  const SteadyTime began = clock_.Steady();
  const std::uint64_t before = sent_;
  SteadyTime tick = began;
  for (SteadyTime now = began; now < began + duration; now = clock_.Steady()) {
    const std::chrono::duration<double> elapsed = now - began;
    const auto due = static_cast<std::uint64_t>(elapsed.count() * per_second);
    if (now > tick + kLate) late_ += due - (sent_ - before);
    while (sent_ - before < due) Put();
    tick = std::max(tick + kTick, now);
    Work(tick - clock_.Steady());
  }
}

void Publishers::Flood(const Ahead& ahead, const std::function<std::uint64_t()>& settled,
                       milliseconds duration) {
  const SteadyTime end = clock_.Steady() + duration;
  const std::uint64_t sent_before = sent_;
  const std::uint64_t settled_before = settled();
  std::uint64_t done = 0;
  SteadyTime look = clock_.Steady() + kLookEvery;
  for (SteadyTime now = clock_.Steady(); now < end; now = clock_.Steady()) {
    if (now >= look) {
      done = settled() - settled_before;
      look = now + kLookEvery;
    }
    // In turn: a connection whose window is full holds up the others, as briefly as an ack takes.
    while (sent_ - sent_before < done + ahead.backlog && NextConnection().unacked < ahead.window) {
      Put();
    }
    Work(kTick);
  }
}

}  // namespace uplink::bench
