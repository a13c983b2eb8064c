#include "schema/cyberwave/judge.h"

#include <array>
#include <exception>
#include <optional>
#include <utility>

#include <boost/json.hpp>

#include "schema/cyberwave/families.h"
#include "schema/cyberwave/head.h"
#include "schema/cyberwave/payload.h"
#include "schema/rules/describe.h"
#include "schema/rules/violations.h"

namespace uplink::cyberwave {
namespace {

namespace js = boost::json;
using model::cyberwave::Body;
using model::cyberwave::Commanded;
using model::cyberwave::Joints;
using model::cyberwave::Media;
using model::cyberwave::Signalling;
using schema::Path;
using schema::Violations;

/// Most messages are parsed within this; larger ones take more from the heap.
constexpr std::size_t kParseBytes = std::size_t{16} * 1024;

/// Whether the source of such a message decides if it is state or a command.
bool MayBeCommanded(TopicKind kind) {
  return kind == TopicKind::kPosition || kind == TopicKind::kRotation ||
         kind == TopicKind::kJointUpdate || kind == TopicKind::kJointStates;
}

MessageClass ClassOf(const Topic& topic, const Reader& in, model::cyberwave::SourceType source) {
  if (MayBeCommanded(topic.kind) && !model::cyberwave::IsState(source)) {
    return MessageClass::kObserved;
  }
  if (topic.kind == TopicKind::kTelemetry && IsReport(in)) return MessageClass::kLive;
  if (topic.kind == TopicKind::kEvent && IsRobotState(in)) return MessageClass::kLive;
  return topic.message_class;
}

/// The body of a message by its topic.
Body BodyOf(const Topic& topic, Reader& in, js::object& object, const JudgeTerms& terms) {
  switch (topic.kind) {
    case TopicKind::kPosition:
      return ReadPosition(in);
    case TopicKind::kRotation:
      return ReadRotation(in);
    case TopicKind::kScale:
      return ReadScale(in);
    case TopicKind::kJointUpdate:
      return ReadJointUpdate(in, terms.prismatic_joints);
    case TopicKind::kJointStates:
      return ReadJointStates(in, terms.prismatic_joints);
    case TopicKind::kMetrics:
      return ReadMetrics(in);
    case TopicKind::kEdgeHealth:
      return ReadEdgeHealth(in, topic.id);
    case TopicKind::kTelemetry:
      return ReadTelemetry(in, object);
    case TopicKind::kNavigateStatus:
      return ReadNavigateStatus(in);
    case TopicKind::kDriverLog:
      return ReadDriverLog(in, object);
    case TopicKind::kEvent:
      return ReadEvent(in, object);
    case TopicKind::kMissionStatus:
      return ReadMissionStatus(in);
    case TopicKind::kGps:
      return ReadGps(in);
    case TopicKind::kBatteryStatus:
      return ReadBatteryStatus(in);
    case TopicKind::kCommand:
    case TopicKind::kNavigateCommand:
      return ReadCommand(in);
    case TopicKind::kEnvironment:
      return ReadEnvironment(in, object, topic.name);
    case TopicKind::kWorkflowRun:
      return ReadWorkflowRun(in, object);
    case TopicKind::kPing:
      return ReadPing(in);
    case TopicKind::kWebrtcOffer:
    case TopicKind::kWebrtcAnswer:
    case TopicKind::kWebrtcCandidate:
    case TopicKind::kDepth:
    case TopicKind::kPointcloud:
    case TopicKind::kOther:
      break;  // not read
  }
  return {};
}

/// A command keeps only how many joints it is about.
Body CommandedOf(const Body& body) {
  Commanded commanded;
  if (const auto* joints = std::get_if<Joints>(&body)) {
    commanded.setpoints = joints->joints.size() + joints->setpoints;
  }
  return commanded;
}

/// Whether a message that decoded is a sign of life of its twin.
bool IsSignOfLife(const Judgement& judgement) {
  const bool kept = judgement.message_class == MessageClass::kLive ||
                    judgement.message_class == MessageClass::kDurable;
  if (!kept || !IsOfTwin(judgement.topic.kind)) return false;
  if (!model::cyberwave::IsState(judgement.head.source.type)) return false;
  const model::Rejection* rejection = judgement.rejection();
  return rejection == nullptr || rejection->reason != model::RejectReason::kIdentityMismatch;
}

void Finish(Judgement& judgement, Violations& violations, Body body) {
  judgement.times_unknown = violations.times_unknown();
  judgement.control_characters = violations.control_characters();
  if (violations.rejected()) {
    judgement.verdict = violations.TakeRejection();
    return;
  }
  judgement.dropped = violations.TakeDropped();
  judgement.unlisted = violations.TakeUnlisted();
  judgement.verdict = std::move(body);
}

void JudgeObject(Judgement& judgement, PayloadReading& reading, const JudgeTerms& terms) {
  js::object& object = reading.value.get_object();
  const Path root;
  Violations none({});
  const Reader unjudged(object, root, none);
  const auto source = SourceTypeOf(unjudged);
  judgement.message_class = ClassOf(judgement.topic, unjudged, source);
  judgement.may_be_kept = judgement.may_be_kept && MayBeKept(judgement.message_class);
  const bool mark = judgement.topic.kind == TopicKind::kTelemetry && IsMark(unjudged);
  Violations violations(
      {.durable = judgement.message_class == MessageClass::kDurable,
       .quoting = judgement.may_be_kept ? schema::Quoting::kQuoted : schema::Quoting::kUnquoted});
  Reader in(object, root, violations);
  judgement.head = ReadHead(in, source, reading.enclosed_seconds);
  Body body = BodyOf(judgement.topic, in, object, terms);
  const bool commanded =
      MayBeCommanded(judgement.topic.kind) && judgement.message_class == MessageClass::kObserved;
  Finish(judgement, violations, commanded ? CommandedOf(body) : std::move(body));
  judgement.sign_of_life = !mark && IsSignOfLife(judgement);
}

void JudgeText(Judgement& judgement, std::string_view payload, const JudgeTerms& terms) {
  std::array<unsigned char, kParseBytes> buffer;  // NOLINT(*-member-init): the parser's to fill
  js::monotonic_resource memory(buffer.data(), buffer.size());
  PayloadReading reading = judgement.topic.kind == TopicKind::kEvent
                               ? ReadBridged(payload, &memory)
                               : ReadPayload(payload, &memory);
  if (reading.rejection) {
    judgement.verdict = *std::move(reading.rejection);
    return;
  }
  JudgeObject(judgement, reading, terms);
}

/// The body of a message that is judged without being read; nothing for other messages.
std::optional<Body> UnreadBody(const Topic& topic, std::size_t bytes) {
  switch (topic.kind) {
    case TopicKind::kWebrtcOffer:
    case TopicKind::kWebrtcAnswer:
    case TopicKind::kWebrtcCandidate:
      return Signalling();
    case TopicKind::kDepth:
    case TopicKind::kPointcloud:
      return Media{.bytes = bytes};
    case TopicKind::kOther:
      return Body();
    case TopicKind::kPosition:
    case TopicKind::kRotation:
    case TopicKind::kScale:
    case TopicKind::kJointUpdate:
    case TopicKind::kMetrics:
    case TopicKind::kEdgeHealth:
    case TopicKind::kTelemetry:
    case TopicKind::kNavigateStatus:
    case TopicKind::kDriverLog:
    case TopicKind::kEvent:
    case TopicKind::kMissionStatus:
    case TopicKind::kGps:
    case TopicKind::kJointStates:
    case TopicKind::kBatteryStatus:
    case TopicKind::kCommand:
    case TopicKind::kNavigateCommand:
    case TopicKind::kEnvironment:
    case TopicKind::kWorkflowRun:
    case TopicKind::kPing:
      break;
  }
  return std::nullopt;
}

}  // namespace

TopicJudgement JudgeTopic(std::string_view topic, std::size_t bytes, const JudgeTerms& terms) {
  TopicJudgement judged;
  Judgement& judgement = judged.judgement;
  TopicReading reading = ParseTopic(topic, terms.prefixes);
  judgement.topic = std::move(reading.topic);
  judgement.payload_bytes = bytes;
  judgement.message_class = judgement.topic.message_class;
  judgement.may_be_kept = MayBeKept(judgement.message_class);
  if (reading.rejection) {
    judgement.verdict = *std::move(reading.rejection);
  } else if (std::optional<Body> body = UnreadBody(judgement.topic, bytes)) {
    judgement.verdict = *std::move(body);
  } else if (bytes > kMessageBytesMax) {
    judgement.verdict = schema::PayloadTooLarge(bytes, kMessageBytesMax).Describe();
  } else {
    judged.decided = false;
  }
  return judged;
}

Judgement JudgePayload(TopicJudgement&& judged, std::string_view payload, const JudgeTerms& terms) {
  if (judged.decided) return std::move(judged.judgement);
  try {
    JudgeText(judged.judgement, payload, terms);
  } catch (const std::exception& error) {
    judged.judgement.verdict = schema::Malformed(error.what()).Describe();
  }
  return std::move(judged.judgement);
}

Judgement JudgeMessage(std::string_view topic, std::string_view payload, const JudgeTerms& terms) {
  return JudgePayload(JudgeTopic(topic, payload.size(), terms), payload, terms);
}

Judgement JudgeUnread(std::string_view topic, std::size_t bytes, const JudgeTerms& terms) {
  TopicJudgement judged = JudgeTopic(topic, bytes, terms);
  if (!judged.decided) {
    judged.judgement.verdict = schema::Malformed("nothing of it was kept").Describe();
  }
  return std::move(judged.judgement);
}

}  // namespace uplink::cyberwave
