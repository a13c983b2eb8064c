#include "tests/support/fault_proxy.h"

#include <algorithm>
#include <cerrno>
#include <string_view>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "schema/base/check.h"

namespace uplink::testing {
namespace {

constexpr std::size_t kPieceBytes = 16 * 1024;
/// How often delayed and trickling bytes are looked at.
constexpr int kLookMs = 1;
constexpr int kIdleMs = 1000;
/// The tag of CommandComplete.
constexpr std::string_view kCommit("COMMIT\0", 7);
constexpr std::string_view kRollback("ROLLBACK\0", 9);

sockaddr_in Loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

}  // namespace

FaultProxy::FaultProxy(std::uint16_t target_port)
    : target_port_(target_port), wake_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  reserved_ = Bound();
  Listen();
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

FaultProxy::~FaultProxy() {
  thread_.request_stop();
  Set(mode_.load());
  thread_.join();
  StopListening();
  for (Pair& pair : pairs_) Cut(pair);
  Reap();
  close(reserved_);
  close(wake_);
}

void FaultProxy::Set(ProxyMode mode) {
  mode_.store(mode);
  const std::uint64_t one = 1;
  UPLINK_CHECK(write(wake_, &one, sizeof(one)) == sizeof(one), "an eventfd takes a count");
}

int FaultProxy::Bound() {
  const int bound = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int on = 1;
  // Two of ours may have it as long as one of them does not listen.
  setsockopt(bound, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  sockaddr_in address = Loopback(port_);
  const auto* const raw = reinterpret_cast<const sockaddr*>(&address);
  UPLINK_CHECK(bind(bound, raw, sizeof(address)) == 0, "the proxy's port is its own");
  socklen_t size = sizeof(address);
  getsockname(bound, reinterpret_cast<sockaddr*>(&address), &size);
  port_ = ntohs(address.sin_port);
  return bound;
}

void FaultProxy::Listen() {
  listener_ = Bound();
  UPLINK_CHECK(listen(listener_, SOMAXCONN) == 0, "the proxy listens");
  listens_.store(true);
}

void FaultProxy::StopListening() {
  listens_.store(false);
  if (listener_ >= 0) close(listener_);
  listener_ = -1;
}

void FaultProxy::Follow() {
  if (mode_.load() == ProxyMode::kRefuse) {
    StopListening();
    for (Pair& pair : pairs_) Cut(pair);
  } else if (listener_ < 0) {
    Listen();
  }
}

void FaultProxy::Accept() {
  const int client = accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (client < 0) return;
  connections_.fetch_add(1);
  const int server = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const sockaddr_in address = Loopback(target_port_);
  if (connect(server, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    close(client);
    close(server);
    return;
  }
  Pair& pair = pairs_.emplace_back();
  pair.request.from = client;
  pair.request.to = server;
  pair.reply.from = server;
  pair.reply.to = client;
  pair.reply.is_reply = true;
}

void FaultProxy::Cut(Pair& pair) {
  if (pair.is_dead) return;
  pair.is_dead = true;
  cuts_.fetch_add(1);
}

void FaultProxy::Reap() {
  pairs_.remove_if([](const Pair& pair) {
    if (!pair.is_dead) return false;
    close(pair.request.from);
    close(pair.request.to);
    return true;
  });
}

void FaultProxy::ReadInto(Pair& pair, Pipe& pipe) {
  std::string piece(kPieceBytes, '\0');
  const ssize_t count = recv(pipe.from, piece.data(), piece.size(), MSG_DONTWAIT);
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (count <= 0) {
    pair.is_dead = true;
    return;
  }
  piece.resize(static_cast<std::size_t>(count));
  if (pipe.is_reply && piece.find(kCommit) != std::string::npos && cut_commit_.exchange(false)) {
    return Cut(pair);
  }
  if (pipe.is_reply && piece.find(kRollback) != std::string::npos &&
      cut_rollback_.exchange(false)) {
    return Cut(pair);
  }
  if (pipe.is_reply && cut_reply_.exchange(false)) {
    piece.resize(piece.size() / 2);
    static_cast<void>(send(pipe.to, piece.data(), piece.size(), MSG_NOSIGNAL));
    return Cut(pair);
  }
  if (pipe.waiting.empty()) {
    pipe.due = clock_.Steady();
    if (mode_.load() == ProxyMode::kDelay) pipe.due += kProxyDelay;
  }
  pipe.waiting += piece;
}

void FaultProxy::WriteFrom(Pair& pair, Pipe& pipe) {
  if (pipe.waiting.empty() || clock_.Steady() < pipe.due) return;
  const bool trickles = pipe.is_reply && mode_.load() == ProxyMode::kTrickle;
  const std::size_t size =
      trickles ? std::min(kTrickleBytes, pipe.waiting.size()) : pipe.waiting.size();
  const ssize_t count = send(pipe.to, pipe.waiting.data(), size, MSG_NOSIGNAL | MSG_DONTWAIT);
  if (count < 0 && errno != EAGAIN && errno != EINTR) pair.is_dead = true;
  if (count > 0) pipe.waiting.erase(0, static_cast<std::size_t>(count));
  if (trickles) pipe.due = clock_.Steady() + milliseconds(kLookMs);
}

void FaultProxy::Run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    Follow();
    Reap();
    const bool is_still = mode_.load() == ProxyMode::kBlackHole;
    bool waits = false;
    std::vector<pollfd> watched{{wake_, POLLIN, 0}, {listener_, POLLIN, 0}};
    for (Pair& pair : pairs_) {
      for (Pipe* pipe : {&pair.request, &pair.reply}) {
        waits = waits || !pipe->waiting.empty();
        // What waits goes first.
        const bool reads = !is_still && pipe->waiting.empty();
        watched.push_back({reads ? pipe->from : -1, POLLIN, 0});
      }
    }
    poll(watched.data(), watched.size(), waits && !is_still ? kLookMs : kIdleMs);
    if (watched[0].revents != 0) {
      std::uint64_t count = 0;
      static_cast<void>(!read(wake_, &count, sizeof(count)));
      continue;
    }
    std::size_t at = 2;
    for (Pair& pair : pairs_) {
      for (Pipe* pipe : {&pair.request, &pair.reply}) {
        const bool ready = watched[at++].revents != 0;
        if (ready && !pair.is_dead) ReadInto(pair, *pipe);
        if (!is_still && !pair.is_dead) WriteFrom(pair, *pipe);
      }
    }
    if (watched[1].revents != 0) Accept();
  }
}

}  // namespace uplink::testing
