#include "tools/uplink-fleet/twin/wrongs.h"

#include <array>
#include <string_view>

namespace uplink::synthetic {
namespace {

using model::RejectReason;

constexpr std::string_view kOfTwin = "twin/{twin}/";
constexpr std::string_view kTelemetry = "twin/{twin}/telemetry";
constexpr std::string_view kEvent = "twin/{twin}/event";
constexpr std::string_view kDriverLog = "twin/{twin}/driverlog";
constexpr std::string_view kNavigate = "twin/{twin}/navigate/status";
constexpr std::string_view kMetrics = "twin/{twin}/metrics";
constexpr std::string_view kEdgeHealth = "twin/{twin}/edge_health";
constexpr std::string_view kPosition = "twin/{twin}/position";
constexpr std::string_view kNoTwin = "twin/not-a-twin/telemetry";
constexpr std::string_view kEnvironment = "environment/{environment}/twin_added";
constexpr std::string_view kNoEnvironment = "environment/not-an-environment/twin_added";

/// What a text is made longer by: `@` in a payload stands for the mark, `#` for the filling.
enum class Filling : std::uint8_t { kNone, kDeep, kBeyondMessage, kBeyondLog, kManyErrors };

struct Kind {
  RejectReason reason;
  std::string_view topic;
  std::string_view payload;
  Filling filling = Filling::kNone;
};

constexpr std::array kKindTable = {
    Kind{RejectReason::kMalformed, kTelemetry, R"({"mark":"@","type":)"},
    Kind{RejectReason::kMalformed, kEvent, R"({"mark":"@","event_type":"e","data":{"v":NaN}})"},
    Kind{RejectReason::kMalformed, kTelemetry, R"({"mark":"@","type":"t","v":#})", Filling::kDeep},
    Kind{RejectReason::kMalformed, kNoTwin, R"({"mark":"@","type":"t"})"},
    Kind{RejectReason::kMalformed, kNoEnvironment, R"({"mark":"@","type":"t","data":{}})"},
    Kind{RejectReason::kTextNotUtf8, kDriverLog, "{\"message\":\"@ \xff\",\"level\":\"info\"}"},
    Kind{RejectReason::kTextNotUtf8, kTelemetry, R"({"mark":"@","type":"\ud800"})"},
    Kind{RejectReason::kTypeMismatch, kEvent, R"(["@"])"},
    Kind{RejectReason::kTypeMismatch, kNavigate,
         R"({"mark":"@","action_id":5,"status":"running"})"},
    Kind{RejectReason::kTypeMismatch, kPosition,
         R"({"mark":"@","position":{"x":"1","y":2,"z":3}})"},
    Kind{RejectReason::kPayloadTooLarge, kEvent, R"({"mark":"@","event_type":"e","data":"#"})",
         Filling::kBeyondMessage},
    Kind{RejectReason::kTooManyItems, kMetrics, R"({"mark":"@","metrics":{"errors":[#]}})",
         Filling::kManyErrors},
    Kind{RejectReason::kTextTooLong, kDriverLog, R"({"mark":"@","message":"#","level":"info"})",
         Filling::kBeyondLog},
    Kind{RejectReason::kMissingField, kNavigate, R"({"mark":"@","status":"running"})"},
    Kind{RejectReason::kMissingField, kDriverLog, R"({"message":"@"})"},
    Kind{RejectReason::kMissingField, kEnvironment, R"({"mark":"@","type":"twin_added"})"},
    Kind{RejectReason::kIdentityMismatch, kEnvironment,
         R"({"mark":"@","type":"twin_removed","data":{}})"},
    Kind{RejectReason::kIdentityMismatch, kEdgeHealth,
         R"({"mark":"@","twin_uuid":"00000000-0000-4000-8000-000000000000","edge_id":"e",)"
         R"("uptime_seconds":1,"streams":{},"stream_count":0,"healthy_streams":0})"},
    Kind{RejectReason::kNotFinite, kTelemetry, R"({"mark":"@","type":"t","v":1e999})"},
    Kind{RejectReason::kOutOfRange, kNavigate,
         R"({"mark":"@","action_id":"a","status":"running","progress":150})"},
    Kind{RejectReason::kOutOfRange, kPosition, R"({"mark":"@","position":{"x":2e9,"y":0,"z":0}})"},
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

}  // namespace

Publication Wrongs::Next() {
  const std::size_t kind = next_;
  next_ = (next_ + 1) % kKindTable.size();
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
                          .topic = speech_.voice.Topic(kind.topic),
                          .payload = std::move(payload),
                          .qos = Qos::k1,
                          .retain = false};
  speech_.account.Wrong(draft.number,
                        {.reason = kind.reason,
                         .topic = publication.topic,
                         .bytes = publication.payload.size(),
                         .of_no_robot = !kind.topic.starts_with(kOfTwin),
                         // Live topics are read at QoS 0.
                         .sure = kind.topic != kPosition && kind.topic != kEdgeHealth});
  return publication;
}

}  // namespace uplink::synthetic
