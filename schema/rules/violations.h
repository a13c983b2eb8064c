#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "schema/model/record.h"
#include "schema/model/rejection.h"

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

/// What was found while one message was judged: the rejection if there is one, the fields dropped,
/// the counts. Confined to one judgement.
class Violations final {
 public:
  explicit Violations(bool durable, SpareTexts* spare = nullptr,
                      std::size_t extras_items_max = SIZE_MAX)
      : durable_(durable), spare_(spare), extras_items_max_(extras_items_max) {}

  /// Most readings in one telemetryExtras: the one bound of items that an operator sets.
  [[nodiscard]] std::size_t extras_items_max() const { return extras_items_max_; }

  /// A violation that rejects whatever the kind: of structure, or of a live message's own key. The
  /// first one stays.
  void Reject(model::Rejection violation) {
    if (!rejection_) rejection_ = std::move(violation);
  }

  /// A violation of content: rejects a durable message, drops the field of a live one. The list of
  /// dropped fields is bounded by the item limits, which are checked before items are read.
  void Content(model::Rejection violation) {
    if (durable_) {
      Reject(std::move(violation));
    } else if (!rejection_) {
      dropped_.push_back(std::move(violation));
    }
  }

  /// For a live message of which nothing is left: rejects it for the first violation, if violations
  /// are the cause (a message that came empty is good).
  void RejectIfAnyDropped() {
    if (!dropped_.empty()) Reject(dropped_.front());
  }

  /// A text that comes with each message of a kind.
  [[nodiscard]] std::string NewText(std::string_view content) {
    return spare_ == nullptr ? std::string(content) : spare_->Take(content);
  }

  void CountUnknownTime() { ++times_unknown_; }
  void CountUnrecognized() { ++enumerants_unrecognized_; }

  [[nodiscard]] bool rejected() const { return rejection_.has_value(); }
  [[nodiscard]] std::uint32_t times_unknown() const { return times_unknown_; }
  [[nodiscard]] std::uint32_t enumerants_unrecognized() const { return enumerants_unrecognized_; }

  [[nodiscard]] model::Rejection TakeRejection() { return *std::move(rejection_); }
  [[nodiscard]] std::vector<model::DroppedField> TakeDropped() { return std::move(dropped_); }

 private:
  bool durable_;
  SpareTexts* spare_;
  std::size_t extras_items_max_;
  std::uint32_t times_unknown_ = 0;
  std::uint32_t enumerants_unrecognized_ = 0;
  std::optional<model::Rejection> rejection_;
  std::vector<model::DroppedField> dropped_;
};

}  // namespace uplink::schema
