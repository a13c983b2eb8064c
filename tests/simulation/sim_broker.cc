#include "tests/simulation/sim_broker.h"

#include <algorithm>
#include <utility>

#include "schema/base/check.h"
#include "tests/support/mqtt_bytes.h"

namespace uplink::simulation {
namespace {

/// Messages that are delivered and not acked at a time.
constexpr std::size_t kWindow = 6;
/// Packet ids, which are given in turn.
constexpr std::uint16_t kIds = 100;
/// PUBACKs that a break may lose.
constexpr std::size_t kAckedKept = 4;

std::size_t U16(std::string_view bytes) {
  return (static_cast<std::size_t>(static_cast<unsigned char>(bytes[0])) << 8U) |
         static_cast<unsigned char>(bytes[1]);
}

/// SUBACK: as it was asked.
std::string Granted(std::string_view subscribe) {
  std::string answer(subscribe.substr(0, 2));
  for (std::size_t next = 2; next < subscribe.size();) {
    next += 2 + U16(subscribe.substr(next));
    answer.push_back(subscribe[next++]);
  }
  return testing::MqttPacket(0x90, answer);
}

}  // namespace

std::shared_ptr<mqtt::Link> SimBroker::Connect(mqtt::LinkEvents& events) {
  lines_.push_back({.link = std::make_shared<testing::FakeLink>(events)});
  return lines_.back().link;
}

void SimBroker::Progress() {
  std::erase_if(lines_, [](const Line& line) { return line.link->closed; });
  // What is done may make another link.
  for (std::size_t i = 0; i < lines_.size(); ++i) ProgressOf(lines_[i]);
}

void SimBroker::ProgressOf(Line& given) {
  const std::shared_ptr<testing::FakeLink> link = given.link;
  const auto line = [&]() -> Line& { return *std::ranges::find(lines_, link, &Line::link); };
  if (!link->closed && clock_.Steady() >= link->wake_at) {
    link->wake_at = SteadyTime::max();
    link->events()->OnDue();
  }
  if (!link->closed && link->opened && !line().up) {
    line().up = true;
    link->events()->OnPhase(mqtt::LinkPhase::kConnecting);
    link->events()->OnUp();
  }
  for (bool moved = true; moved && !link->closed;) {
    moved = false;
    if (link->writing) {
      line().from_server += std::exchange(link->written, {});
      link->FinishWrite();
      Take(line());
      moved = true;
    }
    if (!link->closed && link->reading && !line().to_server.empty()) {
      link->Bring(std::exchange(line().to_server, {}));
      moved = true;
    }
  }
}

void SimBroker::Take(Line& line) {
  std::string& bytes = line.from_server;
  while (bytes.size() >= 2) {
    std::size_t length = 0;
    std::size_t at = 1;
    for (unsigned shift = 0;; shift += 7) {
      const auto digit = static_cast<unsigned char>(bytes[at++]);
      length |= static_cast<std::size_t>(digit & 0x7FU) << shift;
      if (digit < 0x80U) break;
    }
    UPLINK_CHECK(bytes.size() >= at + length, "the server writes whole packets");
    OnPacket(line, static_cast<unsigned char>(bytes[0]) >> 4U, bytes.substr(at, length));
    bytes.erase(0, at + length);
  }
}

void SimBroker::OnPacket(Line& line, unsigned type, std::string_view body) {
  switch (type) {
    case 1: {  // CONNECT: protocol name, level, flags, keep-alive, then the client id
      const std::size_t id_at = 2 + U16(body) + 4;
      line.is_durable = !body.substr(id_at + 2, U16(body.substr(id_at))).ends_with("-live");
      const bool present = line.is_durable && has_session_;
      has_session_ = has_session_ || line.is_durable;
      // What the session subscribed to stands, and what it did not ack comes again.
      line.subscribed = present;
      if (present) SendAgain();
      line.to_server +=
          testing::MqttPacket(0x20, present ? testing::Raw("\1\0") : testing::Raw("\0\0"));
      return;
    }
    case 4:  // PUBACK
      return OnPuback(static_cast<std::uint16_t>(U16(body)));
    case 8:  // SUBSCRIBE
      line.to_server += Granted(body);
      line.subscribed = true;
      return;
    case 12:  // PINGREQ
      line.to_server += testing::MqttPacket(0xD0, "");
      return;
    default:
      return;
  }
}

void SimBroker::OnPuback(std::uint16_t id) {
  const auto acked = std::ranges::find(unacked_, id, &Unacked::id);
  UPLINK_CHECK(acked != unacked_.end(), "a PUBACK answers a PUBLISH");
  acked_(acked->message.number);
  acked_last_.push_back(std::move(*acked));
  unacked_.erase(acked);
  if (acked_last_.size() > kAckedKept) acked_last_.pop_front();
}

SimBroker::Line* SimBroker::Durable() {
  const auto line = std::ranges::find_if(lines_, [](const Line& each) {
    return each.is_durable && each.subscribed && !each.link->closed;
  });
  return line == lines_.end() ? nullptr : &*line;
}

std::uint16_t SimBroker::NextId() {
  do {
    last_id_ = static_cast<std::uint16_t>(last_id_ % kIds + 1);
  } while (std::ranges::find(unacked_, last_id_, &Unacked::id) != unacked_.end());
  return last_id_;
}

bool SimBroker::Deliver() {
  Line* const line = Durable();
  if (line == nullptr || !line->link->reading) return false;
  auto due = std::ranges::find(unacked_, true, &Unacked::due);
  if (due == unacked_.end()) {
    if (queue_.empty() || unacked_.size() >= kWindow) return false;
    const std::uint16_t id = NextId();
    // Its id has a new meaning.
    std::erase_if(acked_last_, [id](const Unacked& acked) { return acked.id == id; });
    unacked_.push_back({std::move(queue_.front()), id});
    queue_.pop_front();
    due = std::prev(unacked_.end());
  }
  due->due = false;
  delivered_ = due->message.number;
  if (due->dup) ++redelivered_;
  line->to_server += testing::PublishBytes{.topic = due->message.topic,
                                           .payload = due->message.payload,
                                           .id = due->id,
                                           .dup = due->dup,
                                           .mqtt5 = false}
                         .Text();
  Progress();
  return true;
}

void SimBroker::Break(std::size_t lost) {
  for (; lost > 0 && !acked_last_.empty(); --lost) {
    unacked_.push_back(std::move(acked_last_.back()));
    acked_last_.pop_back();
  }
  SendAgain();
  for (Line& line : std::exchange(lines_, {})) {
    if (!line.link->closed) line.link->events()->OnDown({mqtt::EndReason::kBroken, "gone"});
  }
}

void SimBroker::SendAgain() {
  acked_last_.clear();
  std::ranges::sort(unacked_, {}, [](const Unacked& each) { return each.message.number; });
  for (Unacked& each : unacked_) {
    each.dup = each.dup || !each.due;
    each.due = true;
  }
}

void SimBroker::Forget(std::size_t lost) {
  lines_.clear();
  Break(lost);
}

}  // namespace uplink::simulation
