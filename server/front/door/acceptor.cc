#include "server/front/door/acceptor.h"

#include <cerrno>
#include <chrono>
#include <system_error>
#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <pthread.h>
#include <sys/socket.h>

#include "server/transport/listenable.h"

namespace uplink::front {

namespace asio = boost::asio;

namespace {

/// Connections that the kernel keeps for us; it takes no more than net.core.somaxconn.
constexpr int kBacklog = 4096;
/// Connections accepted before other work of the thread has its turn.
constexpr int kAcceptsAtOnce = 64;
/// Unsent bytes of a connection that the system keeps: some tenths of a second of a robot's slow
/// network. Bytes on their way to the peer do not count.
constexpr std::size_t kUnsentBytesMax = 32 * 1024;
/// How long accepting pauses when descriptors have run out.
constexpr std::chrono::milliseconds kNoDescriptorsPause{100};

struct InfoFree {
  void operator()(addrinfo* info) const { ::freeaddrinfo(info); }
};

absl::Status CannotListen(const config::ListenAddress& address) {
  return absl::UnavailableError(
      fmt::format("cannot listen on {}: {}", config::ToText(address),
                  std::error_code(errno, std::generic_category()).message()));
}

void SetOption(int descriptor, int level, int option, int value) {
  ::setsockopt(descriptor, level, option, &value, sizeof value);
}

std::uint16_t PortOf(int descriptor) {
  sockaddr_storage bound{};
  socklen_t size = sizeof bound;
  ::getsockname(descriptor, reinterpret_cast<sockaddr*>(&bound), &size);
  // Both families keep the port at the same place.
  return ntohs(reinterpret_cast<const sockaddr_in*>(&bound)->sin_port);
}

void SetUp(int descriptor) {
  SetOption(descriptor, IPPROTO_TCP, TCP_NODELAY, 1);
  // Bytes for a slow reader wait here, where an Ack can pass forwards, not in a system buffer that
  // grows to megabytes.
  SetOption(descriptor, IPPROTO_TCP, TCP_NOTSENT_LOWAT, static_cast<int>(kUnsentBytesMax));
  // TCP_USER_TIMEOUT is not set: it cuts a peer that reads steadily but slowly, since the system
  // counts from when it first had no room. Lifetime tells such a peer from one that is gone.
}

}  // namespace

absl::StatusOr<std::unique_ptr<Acceptor>> Acceptor::Listen(const config::ListenAddress& address) {
  if (absl::Status free = transport::CheckListenable(address); !free.ok()) return free;
  const std::string host = transport::ListenHost(address);
  addrinfo hints{};
  hints.ai_flags = AI_PASSIVE | AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* info = nullptr;
  if (::getaddrinfo(host.c_str(), std::to_string(address.port).c_str(), &hints, &info) != 0) {
    return absl::UnavailableError(
        fmt::format("cannot listen on {}: no literal address", config::ToText(address)));
  }
  const std::unique_ptr<addrinfo, InfoFree> found(info);
  Descriptor listener(::socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (listener.get() < 0) return CannotListen(address);
  SetOption(listener.get(), SOL_SOCKET, SO_REUSEADDR, 1);
  // `::` stands for both families, whatever the machine's default is.
  if (found->ai_family == AF_INET6) SetOption(listener.get(), IPPROTO_IPV6, IPV6_V6ONLY, 0);
  if (::bind(listener.get(), found->ai_addr, found->ai_addrlen) != 0 ||
      ::listen(listener.get(), kBacklog) != 0) {
    return CannotListen(address);
  }
  const std::uint16_t port = PortOf(listener.get());
  return std::unique_ptr<Acceptor>(new Acceptor(listener.Release(), port));
}

Acceptor::Acceptor(int descriptor, std::uint16_t port)
    : port_(port), listener_(context_, descriptor) {}

Acceptor::~Acceptor() { Stop(); }

void Acceptor::Start(Hand hand, Hooks hooks) {
  hand_ = std::move(hand);
  hooks_ = std::move(hooks);
  Wait();
  Tick();
  thread_ = std::jthread([this] {
    ::pthread_setname_np(::pthread_self(), "relay-accept");
    context_.run();
  });
}

void Acceptor::Stop() {
  if (!thread_.joinable()) return;
  context_.stop();
  thread_.join();
  boost::system::error_code ignored;
  listener_.close(ignored);
}

void Acceptor::Post(std::function<void()> work) { asio::post(context_, std::move(work)); }

void Acceptor::Tick() {
  second_.expires_after(std::chrono::seconds(1));
  second_.async_wait([this](const boost::system::error_code& error) {
    if (error) return;
    hooks_.tick();
    Tick();
  });
}

void Acceptor::Wait() {
  listener_.async_wait(asio::posix::stream_descriptor::wait_read,
                       [this](const boost::system::error_code& error) {
                         if (!error) AcceptAll();
                       });
}

void Acceptor::AcceptAll() {
  for (int i = 0; i < kAcceptsAtOnce; ++i) {
    if (!AcceptOne()) return;
  }
  Wait();
}

bool Acceptor::AcceptOne() {
  Accepted accepted;
  socklen_t size = sizeof accepted.peer;
  accepted.descriptor =
      Descriptor(::accept4(listener_.native_handle(), reinterpret_cast<sockaddr*>(&accepted.peer),
                           &size, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (accepted.descriptor.get() >= 0) {
    SetUp(accepted.descriptor.get());
    hand_(std::move(accepted));
    return true;
  }
  switch (errno) {
    case EMFILE:
    case ENFILE:
    case ENOBUFS:
    case ENOMEM:
      Pause(std::error_code(errno, std::generic_category()));
      return false;
    case EAGAIN:
      Wait();
      return false;
    default:  // the peer's own trouble
      return true;
  }
}

void Acceptor::Pause(std::error_code why) {
  hooks_.paused(why);
  // Otherwise Asio would retry at once, again and again.
  pause_.expires_after(kNoDescriptorsPause);
  pause_.async_wait([this](const boost::system::error_code& error) {
    if (!error) AcceptAll();
  });
}

}  // namespace uplink::front
