#include "tests/fuzz/front_bench.h"

#include <algorithm>
#include <utility>

#include "schema/base/check.h"
#include "server/front/call/relay_handler.h"
#include "server/front/http2/limits.h"
#include "server/journal/turns.h"
#include "tests/support/relay_bytes.h"

namespace uplink::fuzz {
namespace {

constexpr std::size_t kStreamsMax = 40;

session::SessionLimits SmallLimits() {
  session::SessionLimits limits;
  limits.in_flight_uplinks_max = 6;
  limits.batch_uplinks_max = 16;
  limits.frame_bytes_max = kFrameBytesMax;
  return limits;
}

journal::JournalLimits SmallJournal() {
  journal::JournalLimits limits;
  limits.bytes_max = 6'000;
  limits.batch_records_max = 4;
  return limits;
}

front::TlsPeer PeerOf(std::uint8_t robot) {
  if (robot == kStranger) {
    return {.identity = absl::UnauthenticatedError("client certificate: it has expired"),
            .expiry = SystemTime{}};
  }
  return {.identity =
              identity::PeerIdentity{
                  .role = identity::Role::kRobot, .fleet = "fuzz", .ruri = RuriOf(robot)},
          .key = {robot},
          .expiry = SystemTime{}};
}

}  // namespace

std::string RuriOf(std::uint8_t number) { return "rcan://fuzz/" + std::to_string(number); }

// --- A connection ---

FrontWire::FrontWire(front::Thread& thread, std::uint8_t robot)
    : thread_(thread),
      robot_(robot),
      grpc_(thread, *this, {PeerOf(robot), origin_, front::kRobotStreamsMax}) {
  Settle();
}

FrontWire::~FrontWire() = default;

void FrontWire::Receive(std::string_view bytes) {
  if (!open_) return;
  thread_.clock.Advance();
  static_cast<void>(grpc_.Receive(bytes));
  Settle();
}

void FrontWire::ReadAgain() {
  reads_ = true;
  thread_.clock.Advance();
  Settle();
}

void FrontWire::Break() {
  if (!std::exchange(open_, false)) return;
  grpc_.Break();
}

void FrontWire::Drain(milliseconds grace) {
  if (!open_) return;
  thread_.clock.Advance();
  const SteadyTime now = thread_.clock.Steady();
  grpc_.Drain({calls(), now, grace}, 0, now + grace);
  Settle();
}

void FrontWire::Keepalive() {
  if (!open_) return;
  grpc_.http2().Ping();
  Settle();
}

void FrontWire::EndNow() {
  if (!open_) return;
  grpc_.End();
  Settle();
}

void FrontWire::Settle() {
  if (!open_) return;
  do {
    grpc_.SettleCalls();
  } while (Flush() || !grpc_.settled());
  if (grpc_.EndIfLast()) static_cast<void>(Flush());
  if (grpc_.http2().over()) Break();
}

bool FrontWire::Flush() {
  if (!reads_) return false;
  grpc_.http2().Gather(thread_.gathered, front::kRecordBytes);
  answers_.Add(thread_.gathered);
  return !thread_.gathered.empty();
}

model::Seq FrontWire::JudgedOn(std::uint32_t stream) const {
  const auto found = watched_.find(stream);
  return found == watched_.end() ? 0 : found->second.order.judged();
}

void FrontWire::Check() {
  UPLINK_CHECK(calls() <= front::kRobotStreamsMax, "a connection has no more calls than it may");
  for (const auto& [id, stream] : answers_.streams()) CheckStream(id, stream);
}

void FrontWire::CheckStream(std::uint32_t id, const testing::RawStream& stream) {
  Watched& watched = watched_[id];
  if (stream.data.size() != watched.bytes) {
    watched.bytes = stream.data.size();
    const std::vector<v1::RelayResponse> frames = testing::FramesOf(stream);
    for (; watched.frames < frames.size(); ++watched.frames) {
      watched.order.Add(frames[watched.frames]);
    }
  }
  if (!stream.ended || stream.reset) return;
  const std::string status = stream.Header(":status");
  UPLINK_CHECK(!status.empty(), "an answer has a status");
  UPLINK_CHECK(status != "200" || !stream.Trailer("grpc-status").empty(), "so has a call's");
}

// --- The thread, and what stands behind it ---

FrontBench::FrontBench() : FrontBench(front::RelayHandler::Served()) {}

FrontBench::FrontBench(transport::Methods methods)
    : limits_(SmallLimits()),
      fleet_(clock_, kRobots, robot::PresenceLimits{}),
      journal_(store_, SmallJournal(), clock_, book_.NewPage(), journal_probe_,
               storage::ProcessId{1}),
      context_(Context()),
      gate_({.streams_max = kStreamsMax}, relay_probe_),
      door_book_({.connections_max = kPlacesMax, .lingers_max = kLingersMax}, relay_probe_,
                 nullptr),
      unfinished_({.bytes_max = kUnfinishedMax, .share_max = kUnfinishedMax / 2}, relay_probe_),
      thread_(
          context_, gate_, [&](const Clock&) { return std::move(methods); }, *this, door_book_,
          unfinished_) {}

FrontBench::~FrontBench() = default;

front::RelayContext FrontBench::Context() {
  return {.clock = clock_,
          .fleet = fleet_,
          .journals = shards_,
          .session_probe = session_probe_,
          .probe = relay_probe_,
          .ledgers = book_,
          .limits = limits_,
          .judge_limits = {},
          .allowances = allowances_,
          .rejects = rejects_,
          .clock_trust = clock_trust_,
          .reports = &connections_.reports(),
          .denied = &denied_};
}

FrontWire& FrontBench::Connect(std::uint8_t robot) {
  Reap();
  if (wires_.size() == kWiresMax) {
    wires_.front()->Break();
    Reap();
  }
  wires_.push_back(std::make_unique<FrontWire>(thread_, robot % kRobots));
  return *wires_.back();
}

void FrontBench::Reap() {
  std::erase_if(wires_, [](const auto& wire) { return !wire->open(); });
}

void FrontBench::DeliverWakes() {
  while (!wakes_.empty()) {
    const std::uint64_t id = *wakes_.begin();
    wakes_.erase(wakes_.begin());
    thread_.clock.Advance();
    const auto found = thread_.calls.find(id);
    if (found == thread_.calls.end()) continue;
    front::CallOwner& owner = found->second->owner();
    found->second->OnWake();
    owner.Settle();
  }
  UPLINK_CHECK(relay_probe_.unfinished_bytes.value() <= std::int64_t{kUnfinishedMax},
               "unfinished frames keep their bound");
}

journal::Step FrontBench::Advance() { return journal_.turns().Advance(); }

void FrontBench::Commit() {
  do {
    DeliverWakes();
  } while (Advance() == journal::Step::kWorked || rejects_.ReadOne());
  DeliverWakes();
}

void FrontBench::Pass(milliseconds time) {
  clock_.Advance(time);
  thread_.clock.Advance();
  const SteadyTime now = thread_.clock.Steady();
  while (const std::optional<std::uint64_t> id = thread_.call_timers.PopDue(now)) {
    front::Call& call = *thread_.calls.at(*id);
    front::CallOwner& owner = call.owner();
    call.OnTimer();
    owner.Settle();
  }
}

void FrontBench::Drain(milliseconds grace) {
  gate_.Close();
  for (const auto& wire : wires_) wire->Drain(grace);
}

void FrontBench::Check() const {
  const metrics::MessageCounts counts = this->counts();
  UPLINK_CHECK(counts.Balanced(), "the conservation law");
  UPLINK_CHECK(counts.in_flight >= 0, "nothing is settled that was not taken");
  std::size_t calls = 0;
  for (const auto& wire : wires_) {
    wire->Check();
    calls += wire->calls();
  }
  UPLINK_CHECK(thread_.calls.size() == calls, "every call is one of a connection's");
  UPLINK_CHECK(gate_.streams() <= calls, "every stream is a call's");
  UPLINK_CHECK(thread_.call_timers.size() <= calls, "every timer is a call's");
}

void FrontBench::End() {
  for (const auto& wire : wires_) wire->Break();
  UPLINK_CHECK(relay_probe_.unfinished_bytes.value() == 0,
               "nothing is kept of a connection that is gone");
  UPLINK_CHECK(gate_.streams() == 0, "every stream left the gate");
  Check();
  Reap();
  UPLINK_CHECK(thread_.calls.empty() && thread_.call_timers.size() == 0, "no call is left");
  store_.Heal();
  Commit();
  Check();
  UPLINK_CHECK(journal_.idle(), "everything commits");
  UPLINK_CHECK(counts().in_flight == 0, "what was taken is settled");
}

}  // namespace uplink::fuzz
