#include "tests/bench/fair/bad_stream.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "tests/bench/load/robots.h"

namespace uplink::bench {
namespace {

/// Of the server's words for an end.
constexpr std::size_t kShownBytesMax = 160;

}  // namespace

std::string BadCounts::Text() const {
  std::string ends;
  for (const auto& [code, times] : ended) ends += fmt::format(" {} with code {}", times, code);
  if (!last_end.empty()) ends += " (the last: " + last_end.substr(0, kShownBytesMax) + ")";
  return fmt::format(
      "{} connections, {} welcomes, {} messages, {:.1f} MiB; {} acks, {} rejects, {} notices;"
      " streams ended:{}",
      connections, welcomes, messages, static_cast<double>(payload_bytes) / 1024 / 1024, acks,
      rejects, notices, ends.empty() ? " none" : ends);
}

BadSession NewBadSession() {
  BadSession session;
  session.id = std::string(NewSessionId().AsBytes());
  return session;
}

BadStream::BadStream(BadWorld& world, BadSession& session, Confirms confirms)
    : world_(world),
      session_(session),
      confirms_(confirms),
      since_(world.clock.Steady()),
      connection_(world.loop, world.link, static_cast<link::StreamEvents&>(*this)) {
  Begin();
}

BadStream::BadStream(BadWorld& world, BadSession& session, std::shared_ptr<link::Http2Link> link)
    : world_(world),
      session_(session),
      confirms_(Confirms::kAcks),
      since_(world.clock.Steady()),
      connection_(std::move(link), world.link.address.text,
                  static_cast<link::StreamEvents&>(*this)) {
  Begin();
}

void BadStream::Begin() {
  ++world_.counts.connections;
  connection_.Connect();
}

void BadStream::Enter(State state) {
  state_ = state;
  since_ = world_.clock.Steady();
}

void BadStream::OnConnected() { Greet(); }

void BadStream::OpenAgain() { Greet(); }

void BadStream::Greet() {
  rejects_ = 0;
  if (!connection_.OpenStream(kRelayMethod)) return Enter(State::kOver);
  Enter(State::kGreeting);
  v1::RelayRequest frame;
  v1::Hello& hello = *frame.mutable_hello();
  hello.set_session_id(session_.id);
  hello.set_schema(v1::PAYLOAD_SCHEMA_ROVER_NEXUS_0_1);
  hello.set_agent_version("bad robot");
  hello.set_robot_ruri(session_.ruri);
  hello.set_declines_forwards(true);
  if (confirms_ == Confirms::kAcks) {
    hello.set_settled_seq(session_.settled_seq);
    hello.set_judged_seq(session_.judged_seq);
  }
  connection_.Send(frame.SerializeAsString());
}

void BadStream::Send(const std::vector<BadMessage>& messages, std::uint64_t step) {
  v1::UplinkBatch& batch = *frame_.mutable_batch();
  batch.clear_uplinks();
  for (const BadMessage& message : messages) {
    v1::Uplink& uplink = *batch.add_uplinks();
    session_.last_seq += step;
    uplink.set_seq(session_.last_seq);
    if (message.content == BadMessage::Content::kRcan) {
      uplink.set_rcan_robot_state(message.bytes);
    } else {
      uplink.set_rover_nexus(message.bytes);
    }
    ++world_.counts.messages;
    world_.counts.payload_bytes += message.bytes.size();
  }
  connection_.Send(frame_.SerializeAsString());
}

void BadStream::OnMessage(std::string_view message) {
  v1::RelayResponse frame;
  if (!frame.ParseFromArray(message.data(), static_cast<int>(message.size()))) return;
  if (frame.has_welcome()) {
    ++world_.counts.welcomes;
    session_.judged_seq = std::max(session_.judged_seq, frame.welcome().committed_seq());
    Enter(State::kOpen);
  } else if (frame.has_ack()) {
    ++world_.counts.acks;
    session_.settled_seq = std::max(session_.settled_seq, frame.ack().through_seq());
    session_.judged_seq =
        std::max({session_.judged_seq, session_.settled_seq, frame.ack().judged_seq()});
  } else if (frame.has_reject()) {
    ++world_.counts.rejects;
    ++rejects_;
    session_.judged_seq = std::max(session_.judged_seq, frame.reject().seq());
  } else if (frame.has_notice()) {
    ++world_.counts.notices;
  }
}

void BadStream::OnEnded(const link::StreamEnd& end) {
  ++world_.counts.ended[end.code];
  world_.counts.last_end = end.message;
  Enter(State::kOver);
}

void BadStream::Cut() {
  gone_ = true;
  connection_.Cut();
  Enter(State::kOver);
}

void BadStream::Freeze() {
  gone_ = true;
  connection_.Freeze();
  Enter(State::kOver);
}

}  // namespace uplink::bench
