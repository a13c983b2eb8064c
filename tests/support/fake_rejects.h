#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "storage/commit_record.h"
#include "storage/rejects.h"

namespace uplink::testing {

/// The Rejects of one session: those in quarantine, and those that are kept outside of it.
class FakeRejects final {
 public:
  void Add(model::Seq seq, const model::Rejection& rejection) { rejects_[seq] = rejection; }
  /// Limited numbers up to `last`.
  void AddRange(const storage::LimitedRange& range, model::Seq last) {
    for (model::Seq seq = range.first; seq <= last; ++seq) rejects_[seq] = range.rejection;
    kept_[last] = range.first;
  }
  /// The row of quarantine goes: so does the Reject, unless a Hello may still ask for it. Returns
  /// whether it is kept.
  bool LoseRow(model::Seq seq, bool asked_for) {
    if (asked_for) {
      kept_[seq] = seq;
    } else {
      rejects_.erase(seq);
    }
    return asked_for;
  }
  /// What is kept goes once a Hello has confirmed it.
  void Confirm(model::Seq settled) {
    while (!kept_.empty() && kept_.begin()->first <= settled) {
      const auto [last, first] = *kept_.begin();
      kept_.erase(kept_.begin());
      rejects_.erase(rejects_.lower_bound(first), rejects_.upper_bound(last));
    }
  }

  [[nodiscard]] std::optional<model::Rejection> Of(model::Seq seq) const {
    const auto found = rejects_.find(seq);
    return found == rejects_.end() ? std::nullopt : std::optional(found->second);
  }
  /// The first `rows_max` in (above, through].
  [[nodiscard]] std::vector<storage::StoredReject> Between(model::Seq above, model::Seq through,
                                                           std::size_t rows_max) const {
    std::vector<storage::StoredReject> rows;
    auto it = rejects_.upper_bound(above);
    for (; it != rejects_.end() && it->first <= through && rows.size() < rows_max; ++it) {
      rows.push_back({it->first, it->second});
    }
    return rows;
  }

 private:
  std::map<model::Seq, model::Rejection> rejects_;
  /// Those of them outside of quarantine: ranges, by their last number.
  std::map<model::Seq, model::Seq> kept_;
};

}  // namespace uplink::testing
