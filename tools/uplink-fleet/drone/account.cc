#include "tools/uplink-fleet/drone/account.h"

#include <algorithm>

#include <fmt/core.h>

#include "tools/uplink-fleet/twin/canonical.h"

namespace uplink::synthetic {
namespace {

using ::uncrew::v1::PublishResponse;

std::string TextOf(const AvatarCall& call, const Outcomes& outcomes) {
  const bool wrong = outcomes.Has(::uncrew::v1::OUTCOME_REJECTED);
  return fmt::format(
      "{} {}: {}{}", call.method, call.number, outcomes.Text(),
      wrong ? fmt::format(" {} of {}", model::ToText(call.due.reason), call.due.field) : "");
}

std::string TextOf(const PublishResponse& answer) {
  return fmt::format("{} {} of {}: {}", ::uncrew::v1::Outcome_Name(answer.outcome()),
                     v1::RejectReason_Name(answer.reason()), answer.field(), answer.detail());
}

}  // namespace

std::string UavIdOf(std::size_t index) { return fmt::format("synthetic-{:04}", index + 1); }
std::string DroneRuri(std::size_t index) {
  return "rcan://local.rcan/uncrew/uav/" + UavIdOf(index);
}

void DroneAccount::Live(const std::string& path, const boost::json::object& shown) {
  live_[path] = CanonicalText(shown);
}

void DroneAccount::Answered(const AvatarCall& call, const PublishResponse& answer,
                            std::size_t tries, std::int64_t now_us) {
  if (last_answer_us_ != 0) {
    longest_silence_us_ = std::max(longest_silence_us_, now_us - last_answer_us_);
  }
  last_answer_us_ = now_us;
  ++answered_;
  waiting_.erase(call.number);
  const bool wrong = call.due.outcomes.Has(::uncrew::v1::OUTCOME_REJECTED);
  // What was sent before may have arrived.
  const Outcomes due = tries > 1 && !wrong ? kIsGood : call.due.outcomes;
  const bool named =
      !wrong || (static_cast<int>(answer.reason()) == static_cast<int>(call.due.reason) &&
                 answer.field() == call.due.field);
  if (due.Has(answer.outcome()) && named && answer.dropped().empty()) return;
  if (undue_answers_++ > 0) return;
  first_due_ = TextOf(call, due);
  first_undue_ = TextOf(answer);
}

std::uint64_t DroneAccount::wrongs() const {
  return static_cast<std::uint64_t>(std::ranges::count_if(
      rows_, [](const auto& row) { return row.second.list == DroneList::kQuarantine; }));
}

std::string QuarantineContent(std::string_view reason, std::string_view field, std::int64_t bytes,
                              std::string_view source, std::string_view method) {
  return fmt::format("{} of \"{}\", {} bytes, source {}, {}", reason, field, bytes, source, method);
}

std::string FaultContent(const FaultWords& words) {
  return fmt::format("{} of {}, {}, {}: \"{}\" at {}", FaultKey(words.id, words.active),
                     words.source, words.severity, words.category, words.description,
                     words.sampled_ms);
}

std::string FaultKey(std::string_view id, bool active) {
  return fmt::format("{} {}", id, active ? "raised" : "cleared");
}

std::string RequestContent(std::string_view kind, std::string_view text,
                           std::int64_t requested_ms) {
  return fmt::format("{}: \"{}\", since {}", kind, text, requested_ms);
}

}  // namespace uplink::synthetic
