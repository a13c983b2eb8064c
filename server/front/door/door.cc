#include "server/front/door/door.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "server/transport/descriptors.h"

namespace uplink::front {
namespace {

using transport::kHandshakesMax;
using transport::kHandshakesWaitingMax;
using transport::kLingersMax;
using transport::kProxyHeadersMax;
using transport::kSpareConnections;
using transport::TurnedAway;

/// A younger handshake may be honest and just slow to be served.
constexpr std::chrono::seconds kSpared{1};
/// Handshakes that were admitted and wait for a thread: some 10 ms of two threads.
constexpr std::size_t kUnbegunMax = 32;
/// The part of the descriptors for connections without a certificate, and the reserve's maximum.
constexpr std::size_t kUnprovenPart = 4;
/// Those whose load balancer has not said where they come from, of connections without a
/// certificate.
constexpr std::size_t kProxyHeadersPart = 4;
constexpr std::size_t kReservePart = 4;

}  // namespace

DoorLimits DoorLimitsFor(const DoorNeeds& needs) {
  const std::size_t descriptors_max = needs.descriptors_max;
  const bool expected = needs.headers == ProxyHeaders::kExpected;
  const std::size_t reserve = std::min(needs.reserved, descriptors_max / kReservePart);
  const std::size_t unproven_max =
      kHandshakesMax + kHandshakesWaitingMax + (expected ? kProxyHeadersMax : 0);
  const std::size_t unproven =
      std::clamp<std::size_t>(descriptors_max / kUnprovenPart, expected ? 3 : 2, unproven_max);
  const std::size_t handshakes = std::clamp<std::size_t>(unproven / 2, 1, kHandshakesMax);
  const std::size_t proxy_headers =
      expected ? std::clamp<std::size_t>(unproven / kProxyHeadersPart, 1, kProxyHeadersMax) : 0;
  const std::size_t lingers = std::min(kLingersMax, handshakes);
  const std::size_t taken = reserve + unproven + lingers;
  const std::size_t left = descriptors_max > taken ? descriptors_max - taken : 1;
  return {.book = {.connections_max = std::min(needs.streams_max + kSpareConnections, left),
                   .lingers_max = lingers},
          .handshakes = {.under_way_max = handshakes,
                         .waiting_max = unproven - handshakes - proxy_headers,
                         .unbegun_max = kUnbegunMax},
          .proxy_headers_max = proxy_headers};
}

Door::Door(const HandshakeLimits& limits, DoorBook& book, transport::RelayProbe& probe,
           Actions actions)
    : book_(book), probe_(probe), actions_(std::move(actions)), queue_(limits) {}

Door::~Door() {
  probe_.handshakes_waiting.Set(0);
  probe_.handshakes_under_way.Set(0);
}

void Door::Arrive(IncomingConnection incoming, SteadyTime now) {
  const std::uint64_t id = next_id_++;
  // Only one exists at a time: it takes no other's place, and a crowd cannot make the server doubt
  // itself.
  if (incoming.origin.own) return actions_.admit(id, std::move(incoming));
  const SourceAddress source = incoming.origin.source;
  const Rank rank = book_.known().IsKnown(source, now) ? Rank::kKnown : Rank::kStranger;
  incoming.origin.known = rank == Rank::kKnown;
  waiting_.emplace(id, std::move(incoming));
  if (const auto refused = queue_.Arrive(id, source, rank, now)) {
    const auto found = waiting_.find(*refused);
    book_.Note(TurnedAway::kCrowded, found->second.origin, now);
    waiting_.erase(found);
  }
  Admit(now);
}

void Door::HandshakeBegan(std::uint64_t id, SteadyTime now) {
  began_.emplace(id, now);
  queue_.Began(id);
  Admit(now);
}

void Door::HandshakeEnded(std::uint64_t id, SteadyTime now) {
  queue_.Ended(id);
  began_.erase(id);
  Admit(now);
}

void Door::Tick(SteadyTime now) {
  // One per place that is wanted: each cut handshake makes room for one that waits.
  for (std::size_t i = 0; i < queue_.waiting(); ++i) {
    const auto longest = queue_.ChooseToCut();
    if (!longest) return;
    const auto began = began_.find(*longest);
    if (began == began_.end() || now < began->second + kSpared) return;
    const std::uint64_t id = *longest;
    queue_.Ended(id);
    began_.erase(began);
    actions_.cut(id);
    Admit(now);
  }
}

void Door::Admit(SteadyTime now) {
  while (const auto id = queue_.Next(now)) {
    const auto found = waiting_.find(*id);
    IncomingConnection incoming = std::move(found->second);
    waiting_.erase(found);
    actions_.admit(*id, std::move(incoming));
  }
  Publish();
}

void Door::Publish() {
  book_.SetPressed(queue_.pressed());
  probe_.handshakes_waiting.Set(static_cast<std::int64_t>(queue_.waiting()));
  probe_.handshakes_under_way.Set(static_cast<std::int64_t>(queue_.under_way()));
}

}  // namespace uplink::front
