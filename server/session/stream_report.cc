#include "server/session/stream_report.h"

#include <optional>
#include <string>
#include <utility>

#include "schema/base/rfc3339.h"
#include "schema/base/utf8.h"
#include "schema/model/ids.h"
#include "server/identity/shown_certificate.h"
#include "server/robot/connection_reports.h"

namespace uplink::session {
namespace {

using transport::EndCause;

/// An agent reads the same for a drain, an age and an expiry; a person reads which one it was.
std::string DetailOf(const transport::Ending& ending, std::optional<SystemTime> parked_until) {
  if (ending.cause == EndCause::kClosed && parked_until) {
    return "the robot said Goodbye until " + Rfc3339(*parked_until);
  }
  const bool told = ending.cause != EndCause::kAge && ending.cause != EndCause::kExpired;
  return std::string(told && !ending.detail.empty() ? ending.detail : SentenceOf(ending.cause));
}

}  // namespace

storage::ConnectionItem StreamReport::Item() const {
  storage::ConnectionItem item;
  item.robot = sources_.robot.robot().id();
  item.id = id_;
  item.source = model::MessageSource::kUplink;
  item.began_at = began_at_;
  item.gateway = sources_.robot.claim().gateway;
  item.agent_version = PrintableUtf8(sources_.robot.agent_version(), model::kAgentVersionBytesMax);
  item.messages = messages_;
  item.bytes = bytes_;
  item.takeovers = sources_.robot.takeovers();
  item.held_back = sources_.reading.held_back();
  item.held_back_why = robot::ToText(sources_.reading.held_back_last());
  if (sources_.connection != nullptr) {
    item.address = sources_.connection->address();
    item.certificate = identity::FactsOf(sources_.connection->certificate());
  }
  return item;
}

void StreamReport::CountFrame(std::size_t bytes) {
  bytes_ += bytes;
  // The Hello comes before its robot is known.
  if (sources_.robot.attached()) sources_.robot.robot().traffic.CountBytes(bytes);
}

void StreamReport::Begin(SteadyTime now) {
  if (sources_.context.reports == nullptr) return;
  began_ = true;
  kept_at_ = now;
  began_at_ = sources_.context.clock.System();
  id_ = sources_.context.reports->Begin(sources_.robot.robot(), Item());
}

void StreamReport::CountMessages(std::size_t messages, SteadyTime now) {
  messages_ += messages;
  sources_.robot.robot().traffic.CountMessages(messages);
  if (!began_ || now - kept_at_ < robot::kConnectionUpdateEvery) return;
  kept_at_ = now;
  sources_.context.reports->Update(Item());
}

void StreamReport::End(const transport::Ending& ending) {
  if (!std::exchange(began_, false)) return;
  storage::ConnectionItem item = Item();
  item.ended = storage::ConnectionEnded{
      .at = sources_.context.clock.System(),
      .why = transport::WhyOf(ending.cause),
      .code = ending.code ? absl::StatusCodeToString(*ending.code) : std::string(),
      .detail = DetailOf(ending, sources_.robot.parked_until())};
  sources_.context.reports->End(sources_.robot.robot(), std::move(item));
}

}  // namespace uplink::session
