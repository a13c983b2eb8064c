#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "schema/cyberwave/limits.h"
#include "schema/cyberwave/names.h"
#include "schema/cyberwave/topic.h"
#include "schema/model/cyberwave/body.h"
#include "schema/model/cyberwave/head.h"
#include "schema/model/rejection.h"

namespace uplink::cyberwave {

/// What messages are judged by. A value.
struct JudgeTerms {
  /// Topic prefixes (cyberwave.topic_prefixes).
  std::vector<std::string> prefixes = {""};
  /// Names of joints that slide (cyberwave.prismatic_joints).
  Names prismatic_joints;
};

/// What judging one message found. A value.
struct Judgement {
  Topic topic;
  /// Of the payload as it came.
  std::size_t payload_bytes = 0;
  /// What the message is, by its topic and by what it says; by its topic alone if it is no JSON
  /// object.
  MessageClass message_class = MessageClass::kOther;
  /// What could be read of it, also if the message is rejected.
  model::cyberwave::Head head;
  std::variant<model::cyberwave::Body, model::Rejection> verdict;
  /// Invalid fields that a live message goes without: the first ones
  /// (schema::kDroppedFieldsListedMax).
  std::vector<model::DroppedField> dropped;
  /// Further ones, by reason.
  std::vector<model::UnlistedFields> unlisted;
  /// Whether the payload may stand in a row of quarantine. Decided by the topic, also if its id is
  /// not good; false too for what is a command by its own words. Where it is false, the rejection
  /// and the dropped fields quote nothing of the message, and KeptTopic hides what its topic holds.
  bool may_be_kept = false;
  /// Times that were taken as unknown because they were absurd.
  std::uint32_t times_unknown = 0;
  /// Control characters in texts of the message, which has U+FFFD in their place.
  std::uint32_t control_characters = 0;
  /// An object of this twin that says how it is, whatever the rules said of it; no mark is one.
  bool sign_of_life = false;

  [[nodiscard]] const model::Rejection* rejection() const {
    return std::get_if<model::Rejection>(&verdict);
  }
  /// Null if the message was rejected.
  [[nodiscard]] const model::cyberwave::Body* body() const {
    return std::get_if<model::cyberwave::Body>(&verdict);
  }
};

/// Judges one message that was published on `topic`. What depends on the messages before it (times,
/// rates, sessions) is not judged here, nor whether it was retained.
///
/// Units:   as the model (schema/model/cyberwave).
/// Errors:  bad content is a Rejection; no input makes it throw or abort. Violations of structure,
///          of what a message must have and of its identity reject; other violations of content
///          reject a durable message, and a live one goes without the field. Unknown fields are
///          ignored, a null is as absent, of a key that stands twice the last one counts.
/// Limits:  limits.h, and those of texts in schema/limits.h; none for media and signalling, which
///          are not read. Thread:  pure; any thread.
[[nodiscard]] Judgement JudgeMessage(std::string_view topic, std::string_view payload,
                                     const JudgeTerms& terms);

/// The first half of JudgeMessage: what topic and size alone decide. A value.
struct TopicJudgement {
  Judgement judgement;
  /// Whether that is all; else JudgePayload is the second half.
  bool decided = true;
};
[[nodiscard]] TopicJudgement JudgeTopic(std::string_view topic, std::size_t bytes,
                                        const JudgeTerms& terms);
[[nodiscard]] Judgement JudgePayload(TopicJudgement&& judged, std::string_view payload,
                                     const JudgeTerms& terms);

/// The same for a payload of `bytes` that was not kept: media and signalling are counted, other
/// messages are judged by their size alone, which is over the limit.
[[nodiscard]] Judgement JudgeUnread(std::string_view topic, std::size_t bytes,
                                    const JudgeTerms& terms);

}  // namespace uplink::cyberwave
