#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "schema/limits.h"
#include "schema/model/rejection.h"
#include "schema/rules/describe.h"

namespace uplink::schema {

/// Texts of live messages whose memory is used again: two, since a message is judged while the one
/// before it is still held. Confined to one thread.
class SpareTexts final {
 public:
  /// A text with this content, in memory that was given before if there is any.
  [[nodiscard]] std::string Take(std::string_view content) {
    std::string text = std::exchange(Larger() ? texts_.front() : texts_.back(), {});
    text.assign(content);
    return text;
  }
  void Give(std::string&& text) { (Larger() ? texts_.back() : texts_.front()) = std::move(text); }

 private:
  /// The first has room for more than the second.
  [[nodiscard]] bool Larger() const { return texts_.front().capacity() > texts_.back().capacity(); }

  std::array<std::string, 2> texts_;
};

/// Whether a violation's sentence may quote the message.
enum class Quoting : std::uint8_t { kQuoted, kUnquoted };

/// What was found while one message was judged: the rejection if there is one, the fields dropped,
/// the counts. Confined to one judgement.
class Violations final {
 public:
  /// What judgement of one message goes by.
  struct Terms {
    /// A violation of content rejects.
    bool durable = false;
    SpareTexts* spare = nullptr;
    /// Most readings in one telemetryExtras: the one bound of items that an operator sets.
    std::size_t extras_items_max = SIZE_MAX;
    TextForm texts = TextForm::kAsSent;
    Quoting quoting = Quoting::kQuoted;
  };
  explicit Violations(const Terms& terms) : terms_(terms) {}

  /// Whether a violation of content rejects.
  [[nodiscard]] bool durable() const { return terms_.durable; }
  [[nodiscard]] std::size_t extras_items_max() const { return terms_.extras_items_max; }
  /// The limit of a text that may have `bytes_max` bytes as it is sent.
  [[nodiscard]] std::size_t TextBytesMax(std::size_t bytes_max) const {
    return schema::TextBytesMax(terms_.texts, bytes_max);
  }

  /// A violation that rejects whatever the kind: of structure, or of a live message's own key. The
  /// first one stays.
  void Reject(const Violation& violation) {
    if (!rejection_) rejection_ = InWords(violation);
  }

  /// A violation of content: rejects a durable message, drops the field of a live one. The first
  /// kDroppedFieldsListedMax are put in words, further ones are only counted.
  void Content(const Violation& violation) {
    if (terms_.durable) return Reject(violation);
    if (rejection_) return;
    if (dropped_.size() < kDroppedFieldsListedMax) {
      dropped_.push_back(InWords(violation));
    } else {
      CountUnlisted(violation.reason);
    }
  }

  /// For a live message that is empty by now: rejects it for the first violation, if violations
  /// are the cause (a message that came empty is good).
  void RejectIfAnyDropped() {
    if (!dropped_.empty() && !rejection_) rejection_ = dropped_.front();
  }

  /// A text that comes with each message of a kind.
  [[nodiscard]] std::string NewText(std::string_view content) {
    return terms_.spare == nullptr ? std::string(content) : terms_.spare->Take(content);
  }

  void CountUnknownTime() { ++times_unknown_; }
  void CountUnrecognized() { ++enumerants_unrecognized_; }
  void CountControls(std::size_t controls) {
    control_characters_ += static_cast<std::uint32_t>(controls);
  }

  [[nodiscard]] bool rejected() const { return rejection_.has_value(); }
  [[nodiscard]] std::uint32_t times_unknown() const { return times_unknown_; }
  [[nodiscard]] std::uint32_t enumerants_unrecognized() const { return enumerants_unrecognized_; }

  /// Of what was kept: 0 once the message is rejected.
  [[nodiscard]] std::uint32_t control_characters() const {
    return rejection_ ? 0 : control_characters_;
  }

  [[nodiscard]] model::Rejection TakeRejection() { return *std::move(rejection_); }
  [[nodiscard]] std::vector<model::DroppedField> TakeDropped() { return std::move(dropped_); }
  [[nodiscard]] std::vector<model::UnlistedFields> TakeUnlisted() { return std::move(unlisted_); }

 private:
  [[nodiscard]] model::Rejection InWords(const Violation& violation) const {
    return terms_.quoting == Quoting::kQuoted ? violation.Describe() : violation.DescribeUnquoted();
  }

  void CountUnlisted(model::RejectReason reason) {
    for (model::UnlistedFields& unlisted : unlisted_) {
      if (unlisted.reason != reason) continue;
      ++unlisted.fields;
      return;
    }
    unlisted_.push_back({.reason = reason, .fields = 1});
  }

  Terms terms_;
  std::uint32_t times_unknown_ = 0;
  std::uint32_t enumerants_unrecognized_ = 0;
  std::uint32_t control_characters_ = 0;
  std::optional<model::Rejection> rejection_;
  std::vector<model::DroppedField> dropped_;
  std::vector<model::UnlistedFields> unlisted_;
};

}  // namespace uplink::schema
