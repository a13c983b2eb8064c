#include "tools/uplink-fleet/twin/wrongs.h"

#include <array>
#include <string_view>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

using model::RejectReason;

enum class To : std::uint8_t {
  kTelemetry,
  kEvent,
  kDriverLog,
  kNavigate,
  kMetrics,
  kEdgeHealth,
  kPosition,
  kNoTwin,
  kEnvironment,
  kNoEnvironment,
};

/// What a text is made longer by: `@` in a payload stands for the mark, `#` for the filling.
enum class Filling : std::uint8_t { kNone, kDeep, kBeyondMessage, kBeyondLog, kManyErrors };

struct Kind {
  RejectReason reason;
  To to;
  std::string_view payload;
  Filling filling = Filling::kNone;
};

constexpr std::array kKindTable = {
    Kind{RejectReason::kMalformed, To::kTelemetry, R"({"mark":"@","type":)"},
    Kind{RejectReason::kMalformed, To::kEvent, R"({"mark":"@","event_type":"e","data":{"v":NaN}})"},
    Kind{RejectReason::kMalformed, To::kTelemetry, R"({"mark":"@","type":"t","v":#})",
         Filling::kDeep},
    Kind{RejectReason::kMalformed, To::kNoTwin, R"({"mark":"@","type":"t"})"},
    Kind{RejectReason::kMalformed, To::kNoEnvironment, R"({"mark":"@","type":"t","data":{}})"},
    Kind{RejectReason::kTextNotUtf8, To::kDriverLog, "{\"message\":\"@ \xff\",\"level\":\"info\"}"},
    Kind{RejectReason::kTextNotUtf8, To::kTelemetry, R"({"mark":"@","type":"\ud800"})"},
    Kind{RejectReason::kTypeMismatch, To::kEvent, R"(["@"])"},
    Kind{RejectReason::kTypeMismatch, To::kNavigate,
         R"({"mark":"@","action_id":5,"status":"running"})"},
    Kind{RejectReason::kTypeMismatch, To::kPosition,
         R"({"mark":"@","position":{"x":"1","y":2,"z":3}})"},
    Kind{RejectReason::kPayloadTooLarge, To::kEvent, R"({"mark":"@","event_type":"e","data":"#"})",
         Filling::kBeyondMessage},
    Kind{RejectReason::kTooManyItems, To::kMetrics, R"({"mark":"@","metrics":{"errors":[#]}})",
         Filling::kManyErrors},
    Kind{RejectReason::kTextTooLong, To::kDriverLog, R"({"mark":"@","message":"#","level":"info"})",
         Filling::kBeyondLog},
    Kind{RejectReason::kMissingField, To::kNavigate, R"({"mark":"@","status":"running"})"},
    Kind{RejectReason::kMissingField, To::kDriverLog, R"({"message":"@"})"},
    Kind{RejectReason::kMissingField, To::kEnvironment, R"({"mark":"@","type":"twin_added"})"},
    Kind{RejectReason::kIdentityMismatch, To::kEnvironment,
         R"({"mark":"@","type":"twin_removed","data":{}})"},
    Kind{RejectReason::kIdentityMismatch, To::kEdgeHealth,
         R"({"mark":"@","twin_uuid":"00000000-0000-4000-8000-000000000000","edge_id":"e",)"
         R"("uptime_seconds":1,"streams":{},"stream_count":0,"healthy_streams":0})"},
    Kind{RejectReason::kNotFinite, To::kTelemetry, R"({"mark":"@","type":"t","v":1e999})"},
    Kind{RejectReason::kOutOfRange, To::kNavigate,
         R"({"mark":"@","action_id":"a","status":"running","progress":150})"},
    Kind{RejectReason::kOutOfRange, To::kPosition,
         R"({"mark":"@","position":{"x":2e9,"y":0,"z":0}})"},
};

std::string FillingOf(Filling filling) {
  constexpr std::size_t kDeepLevels = 33;
  constexpr std::size_t kMessageBytesMax = std::size_t{64} * 1024;
  constexpr std::size_t kLogBytesMax = 8192;
  constexpr std::size_t kErrorsMax = 64;
  switch (filling) {
    case Filling::kNone:
      return {};
    case Filling::kDeep:
      return std::string(kDeepLevels, '[') + std::string(kDeepLevels, ']');
    case Filling::kBeyondMessage:
      return std::string(kMessageBytesMax, 'x');
    case Filling::kBeyondLog:
      return std::string(kLogBytesMax + 1, 'x');
    case Filling::kManyErrors: {
      std::string errors = "\"e\"";
      for (std::size_t i = 0; i < kErrorsMax; ++i) errors += ",\"e\"";
      return errors;
    }
  }
  return {};
}

std::string PathOf(To to, const TwinIds& ids) {
  const auto below = [&ids](std::string_view tail) {
    return fmt::format("twin/{}/{}", ids.twin, tail);
  };
  switch (to) {
    case To::kTelemetry:
      return below("telemetry");
    case To::kEvent:
      return below("event");
    case To::kDriverLog:
      return below("driverlog");
    case To::kNavigate:
      return below("navigate/status");
    case To::kMetrics:
      return below("metrics");
    case To::kEdgeHealth:
      return below("edge_health");
    case To::kPosition:
      return below("position");
    case To::kNoTwin:
      return "twin/not-a-twin/telemetry";
    case To::kEnvironment:
      return fmt::format("environment/{}/twin_added", ids.environment);
    case To::kNoEnvironment:
      return "environment/not-an-environment/twin_added";
  }
  return {};
}

bool OfNoRobot(To to) {
  return to == To::kNoTwin || to == To::kEnvironment || to == To::kNoEnvironment;
}

bool IsLive(To to) { return to == To::kPosition || to == To::kEdgeHealth; }

}  // namespace

const std::size_t Wrongs::kKinds = kKindTable.size();

Publication Wrongs::Next() {
  const std::size_t kind = next_;
  next_ = (next_ + 1) % kKinds;
  return Make(kind);
}

Publication Wrongs::Make(std::size_t index) {
  const Kind& kind = kKindTable.at(index);
  const Draft draft = speech_.voice.BeginBare();
  std::string payload;
  for (const char c : kind.payload) {
    if (c == '@') {
      payload += speech_.voice.MarkOf(draft);
    } else if (c == '#') {
      payload += FillingOf(kind.filling);
    } else {
      payload += c;
    }
  }
  Publication publication{.number = draft.number,
                          .topic = speech_.voice.Topic(PathOf(kind.to, speech_.voice.ids())),
                          .payload = std::move(payload),
                          .qos = Qos::k1,
                          .retain = false};
  speech_.account.Wrong(draft.number, {.reason = kind.reason,
                                       .topic = publication.topic,
                                       .bytes = publication.payload.size(),
                                       .of_no_robot = OfNoRobot(kind.to),
                                       .sure = !IsLive(kind.to)});
  return publication;
}

}  // namespace uplink::synthetic
