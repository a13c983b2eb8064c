#include "tests/unit/server/session/session_bench.h"

#include <utility>
#include <variant>

#include <fmt/format.h>

#include "schema/base/check.h"
#include "schema/encode.h"
#include "server/journal/turns.h"

namespace uplink::session {
namespace {

constexpr std::string_view kRefusedId = "REFUSE-ME";

std::optional<model::Rejection> RefuseMarked(const storage::CommitRecord& record) {
  const auto* good = std::get_if<model::Record>(&record.content);
  const auto* fault = good == nullptr ? nullptr : std::get_if<model::Fault>(&good->body());
  if (fault == nullptr || fault->fault_id != kRefusedId) return std::nullopt;
  return model::Rejection{model::RejectReason::kStoreRefused, "faultId", "refused on order"};
}

std::string FaultOf(std::string_view id) {
  model::Fault fault;
  fault.unix_time_ms = 1'763'683'200'000;
  fault.fault_id = id;
  fault.source = "bench";
  fault.active = true;
  return schema::Encode(fault);
}

std::string_view ReasonText(v1::RejectReason reason) {
  return model::ToText(static_cast<model::RejectReason>(reason));
}

/// Without the kinds' prefix, RESEND_KIND_.
std::string ResendLine(const v1::ResendRequest& request) {
  constexpr std::size_t kPrefix = 12;
  std::string line = "resend";
  for (const int kind : request.kinds()) {
    line += " " + v1::ResendKind_Name(static_cast<v1::ResendKind>(kind)).substr(kPrefix);
  }
  return line;
}

}  // namespace

model::SessionId SessionOf(std::uint8_t number) {
  std::array<std::uint8_t, model::SessionId::kBytes> bytes{};
  bytes.front() = number;
  return model::SessionId(bytes);
}

std::string Fault(std::string_view id) { return FaultOf(id); }

std::string BadFault() { return FaultOf(""); }

std::string RefusedFault() { return FaultOf(kRefusedId); }

std::string Motion(double lat_deg) {
  model::MotionTelemetry motion;
  motion.unix_time_ms = 1'763'683'200'000;
  motion.pose = model::Pose{.lat_deg = lat_deg, .lon_deg = 8};
  return schema::Encode(motion);
}

v1::RelayRequest HelloFrame(const model::SessionId& session, model::Seq settled,
                            model::Seq judged) {
  v1::RelayRequest frame;
  v1::Hello& hello = *frame.mutable_hello();
  hello.set_session_id(std::string(session.AsBytes()));
  hello.set_settled_seq(settled);
  hello.set_judged_seq(judged);
  hello.set_schema(v1::PAYLOAD_SCHEMA_ROVER_NEXUS_0_1);
  return frame;
}

v1::RelayRequest BatchFrame(const std::vector<Message>& messages) {
  v1::RelayRequest frame;
  v1::UplinkBatch& batch = *frame.mutable_batch();
  for (const Message& message : messages) {
    v1::Uplink& uplink = *batch.add_uplinks();
    uplink.set_seq(message.seq);
    uplink.set_rover_nexus(message.payload);
  }
  return frame;
}

std::vector<Message> Messages(model::Seq first, model::Seq last, const std::string& payload) {
  std::vector<Message> messages;
  for (model::Seq seq = first; seq <= last; ++seq) messages.push_back({seq, payload});
  return messages;
}

std::string ToLine(const v1::RelayResponse& frame) {
  switch (frame.frame_case()) {
    case v1::RelayResponse::kWelcome:
      return fmt::format("welcome {}", frame.welcome().committed_seq());
    case v1::RelayResponse::kAck:
      return fmt::format("ack {} judged {}", frame.ack().through_seq(), frame.ack().judged_seq());
    case v1::RelayResponse::kReject:
      return fmt::format("reject {} {} {}", frame.reject().seq(),
                         ReasonText(frame.reject().reason()), frame.reject().field());
    case v1::RelayResponse::kNotice:
      return fmt::format("notice {} {} {}", frame.notice().seq(),
                         ReasonText(frame.notice().reason()), frame.notice().field());
    case v1::RelayResponse::kDrain:
      return fmt::format("drain {}", frame.drain().grace_ms());
    case v1::RelayResponse::kForward:
      return fmt::format("forward {} {}", static_cast<int>(frame.forward().kind()),
                         frame.forward().origin_ruri());
    case v1::RelayResponse::kResendRequest:
      return ResendLine(frame.resend_request());
    case v1::RelayResponse::FRAME_NOT_SET:
      break;
  }
  return "unexpected frame";
}

BenchStream::BenchStream(const SessionContext& context, identity::PeerIdentity peer,
                         loop::StreamRef self)
    : self_(self), session_(context, {std::move(peer)}, self, *this, *this) {}

BenchStream::~BenchStream() = default;

void BenchStream::Write(const v1::RelayResponse& frame) {
  UPLINK_CHECK(!writing_, "one write at a time");
  writing_ = true;
  frames_.push_back(frame);
  if (const auto job = std::exchange(at_next_write_, nullptr)) job();
}

void BenchStream::WriteEncoded(std::span<const EncodedFrame> frames) {
  UPLINK_CHECK(!writing_, "one write at a time");
  writing_ = true;
  for (const EncodedFrame& bytes : frames) {
    UPLINK_CHECK(frames_.emplace_back().ParseFromString(*bytes), "an encoded frame is one");
  }
}

void BenchStream::SendBytes(std::string_view bytes) {
  SendBytesOnce(bytes);
  // It has given its thread to others, and its turn comes again.
  while (static_cast<BenchServer&>(*self_.inbox).TakeWake(self_.stream)) Wake();
}

void BenchStream::SendBytesOnce(std::string_view bytes) {
  UPLINK_CHECK(reading_, "the server does not read");
  reading_ = false;
  session_.OnFrame(bytes);
  Pump();
}

void BenchStream::SendTooLarge(std::uint64_t bytes) {
  UPLINK_CHECK(reading_, "the server does not read");
  reading_ = false;
  session_.OnFrameTooLarge(bytes);
  Pump();
}

void BenchStream::HalfClose() {
  UPLINK_CHECK(reading_, "the server does not read");
  reading_ = false;
  session_.OnHalfClose();
  Pump();
}

void BenchStream::Break() {
  agent_reads_ = false;
  reading_ = false;
  session_.OnBroken();
}

void BenchStream::ReadAgain() {
  agent_reads_ = true;
  Pump();
}

void BenchStream::ReadOne() {
  if (!writing_ || session_.done()) return;
  writing_ = false;
  session_.OnWritten();
}

void BenchStream::Pump() {
  while (agent_reads_ && writing_ && !session_.done()) ReadOne();
}

std::vector<std::string> BenchStream::TakeLines() {
  std::vector<std::string> lines = TakeAllLines();
  std::erase_if(lines, [](const std::string& line) { return line.starts_with("resend "); });
  return lines;
}

std::vector<std::string> BenchStream::TakeAllLines() {
  std::vector<std::string> lines;
  for (; told_ < frames_.size(); ++told_) lines.push_back(ToLine(frames_[told_]));
  return lines;
}

std::string BenchStream::end() const {
  if (!status_) return "";
  if (status_->ok()) return "OK";
  return fmt::format("{}: {}", absl::StatusCodeToString(status_->code()),
                     std::string(status_->message()));
}

void BenchStream::Wake() {
  if (session_.done()) return;
  session_.OnWake();
  Pump();
}

void BenchStream::Timer() {
  if (session_.done()) return;
  session_.OnTimer();
  Pump();
}

void BenchStream::Drain(milliseconds grace, transport::EndCause cause) {
  session_.OnDrain(grace, cause);
  Pump();
}

BenchServer::BenchServer(testing::ManualClock& clock, testing::FakeDatabase& database,
                         std::uint8_t process, const BenchLimits& limits)
    : clock_(clock),
      limits_(limits),
      store_(database, storage::ProcessId{process}),
      allowances_(limits.allowance),
      fleet_(clock, limits.robots_max, {}),
      journal_(store_, limits_.journal, clock, book_.NewPage(), journal_probe_,
               storage::ProcessId{process}),
      judge_({}),
      ledger_(book_.NewPage()) {
  store_.SetRules({.refuse = RefuseMarked});
}

BenchServer::~BenchServer() = default;

BenchStream& BenchServer::OpenAs(identity::PeerIdentity peer) {
  const SessionContext context{.clock = clock_,
                               .fleet = fleet_,
                               .journals = shards_,
                               .probe = probe_,
                               .ledger = ledger_,
                               .judge = judge_,
                               .limits = limits_.session,
                               .scratch = scratch_,
                               .allowances = allowances_,
                               .rejects = rejects_,
                               .clock_trust = clock_trust_,
                               .pressed = &pressed,
                               .forwards = forwards,
                               .reports = reports};
  const std::uint64_t id = streams_.size() + 1;
  auto stream = std::make_unique<BenchStream>(context, std::move(peer),
                                              loop::StreamRef{.inbox = this, .stream = id});
  BenchStream& opened = *stream;
  streams_.emplace(id, std::move(stream));
  opened.session().Start();
  return opened;
}

BenchStream& BenchServer::Open(std::string_view ruri) {
  return OpenAs({.role = identity::Role::kRobot, .fleet = "bench", .ruri = std::string(ruri)});
}

BenchStream& BenchServer::Connect(const model::SessionId& session, model::Seq settled,
                                  model::Seq judged, std::string_view ruri) {
  BenchStream& stream = Open(ruri);
  stream.Send(HelloFrame(session, settled, judged));
  DeliverWakes();
  Advance();
  DeliverWakes();
  return stream;
}

journal::Step BenchServer::Advance() {
  const journal::Step step = journal_.turns().Advance();
  UPLINK_CHECK(counts().Balanced(), "the conservation law");
  return step;
}

void BenchServer::Commit() {
  do {
    DeliverWakes();
  } while (Advance() == journal::Step::kWorked || rejects_.ReadOne());
  DeliverWakes();
}

bool BenchServer::ReadRejects() {
  const bool read = rejects_.ReadOne();
  DeliverWakes();
  return read;
}

void BenchServer::DeliverWakes() {
  while (!wakes_.empty()) {
    const std::uint64_t stream = *wakes_.begin();
    wakes_.erase(wakes_.begin());
    streams_.at(stream)->Wake();
    UPLINK_CHECK(counts().Balanced(), "the conservation law");
  }
}

void BenchServer::Pass(milliseconds time) {
  // A transport asks for the deadline after each call, so before the time has come.
  std::vector<BenchStream*> due;
  const SteadyTime now = clock_.Steady() + time;
  for (const auto& [id, stream] : streams_) {
    const auto deadline = stream->session().deadline();
    if (deadline && *deadline <= now) due.push_back(stream.get());
  }
  clock_.Advance(time);
  for (BenchStream* const stream : due) stream->Timer();
  UPLINK_CHECK(counts().Balanced(), "the conservation law");
}

void BenchServer::StoreAway() { store_.FailNext(1'000'000, testing::FailAt::kBefore); }

void BenchServer::StoreBack() { store_.Heal(); }

robot::Robot& BenchServer::robot(std::string_view ruri) {
  const fleet::RobotPtr found = fleet_.Find(ruri);
  UPLINK_CHECK(found != nullptr, "the robot was never seen");
  return *found;
}

}  // namespace uplink::session
