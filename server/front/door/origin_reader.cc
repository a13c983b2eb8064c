#include "server/front/door/origin_reader.h"

#include <array>
#include <cerrno>
#include <utility>

#include <sys/socket.h>

namespace uplink::front {

namespace asio = boost::asio;
using transport::TurnedAway;

OriginReader::Guest::Guest(asio::io_context& context, Descriptor its_descriptor,
                           Origin load_balancer, SteadyTime until)
    : descriptor(std::move(its_descriptor)),
      watch(context),
      origin(std::move(load_balancer)),
      by(until) {}

OriginReader::Guest::~Guest() {
  // Otherwise both `watch` and `descriptor` would close it.
  watch.release();
}

OriginReader::OriginReader(asio::io_context& context, DoorBook& book, transport::RelayProbe& probe,
                           const Clock& clock, Setup setup)
    : context_(context), book_(book), probe_(probe), clock_(clock), setup_(std::move(setup)) {}

OriginReader::~OriginReader() { probe_.proxy_headers_waiting.Set(0); }

void OriginReader::Arrive(Accepted accepted) {
  Origin origin = OriginOf(accepted.peer);
  origin.own = IsOwnProbe(accepted.descriptor.get(), accepted.peer, probe_.own_port.load());
  origin.health_check = origin.own;
  if (!config::Contains(setup_.load_balancers, accepted.peer)) {
    return setup_.hand({std::move(accepted.descriptor), std::move(origin)});
  }
  const std::uint64_t id = next_id_++;
  const auto added = waiting_.try_emplace(id, context_, std::move(accepted.descriptor),
                                          std::move(origin), clock_.Steady() + kProxyHeaderWait);
  // Most often the header has come with the connection.
  Serve(id, added.first->second);
  if (waiting_.size() > setup_.waiting_max) {
    TurnAway(waiting_.begin()->second);
    Forget(waiting_.begin()->first);
  }
}

void OriginReader::Tick() {
  const SteadyTime now = clock_.Steady();
  while (!waiting_.empty() && waiting_.begin()->second.by <= now) {
    TurnAway(waiting_.begin()->second);
    Forget(waiting_.begin()->first);
  }
}

void OriginReader::Serve(std::uint64_t id, Guest& guest) {
  const bool there = Read(guest);
  switch (guest.header.result()) {
    case ProxyHeader::Result::kMore:
      if (there) return Wait(id, guest);
      // A peer that leaves without a byte only checked whether we answer.
      if (guest.header.begun()) TurnAway(guest);
      break;
    case ProxyHeader::Result::kRelayed:
      HandOn(guest, OriginOf(guest.header.source()));
      break;
    case ProxyHeader::Result::kLocal:
      guest.origin.health_check = true;
      HandOn(guest, std::move(guest.origin));
      break;
    case ProxyHeader::Result::kUntold:
      HandOn(guest, std::move(guest.origin));
      break;
    case ProxyHeader::Result::kInvalid:
      TurnAway(guest);
      break;
  }
  Forget(id);
}

bool OriginReader::Read(Guest& guest) {
  std::array<char, ProxyHeader::kRestBytesMax> bytes{};
  static_assert(ProxyHeader::kFixedBytes <= ProxyHeader::kRestBytesMax);
  while (const std::size_t wanted = guest.header.wanted()) {
    const ssize_t count = ::recv(guest.descriptor.get(), bytes.data(), wanted, MSG_DONTWAIT);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno == EAGAIN) return true;
    if (count <= 0) return false;
    guest.header.Take({bytes.data(), static_cast<std::size_t>(count)});
  }
  return true;
}

void OriginReader::Wait(std::uint64_t id, Guest& guest) {
  if (!guest.watch.is_open()) {
    boost::system::error_code error;
    guest.watch.assign(guest.descriptor.get(), error);
    if (error) return Forget(id);  // the machine watches no more descriptors
  }
  guest.watch.async_wait(asio::posix::stream_descriptor::wait_read,
                         [this, id](const boost::system::error_code& error) {
                           if (!error) OnReadable(id);
                         });
  probe_.proxy_headers_waiting.Set(static_cast<std::int64_t>(waiting_.size()));
}

void OriginReader::OnReadable(std::uint64_t id) {
  // It may have gone since the system reported it.
  if (const auto found = waiting_.find(id); found != waiting_.end()) Serve(id, found->second);
}

void OriginReader::HandOn(Guest& guest, Origin origin) {
  // Its next owner watches it in another context.
  guest.watch.release();
  setup_.hand({std::move(guest.descriptor), std::move(origin)});
}

void OriginReader::TurnAway(const Guest& guest) {
  book_.Note(TurnedAway::kProxyHeader, guest.origin, clock_.Steady());
}

void OriginReader::Forget(std::uint64_t id) {
  waiting_.erase(id);
  probe_.proxy_headers_waiting.Set(static_cast<std::int64_t>(waiting_.size()));
}

}  // namespace uplink::front
