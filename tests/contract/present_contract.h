#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/contract/present_kinds.h"
#include "tests/contract/store_contract.h"
#include "tests/support/fake_trust.h"

namespace uplink::testing {

/// What shapes and objects do alike: each test runs for both, on an empty store.
class PresentContract : public StoreContract {
 protected:
  /// Lives of test rows whose expiry does not matter.
  static constexpr std::int64_t kLongMs = 1'000'000'000;

  void ForEachKind(const std::function<void(const PresentKind& kind)>& test) {
    storage::StoreRules rules;
    rules.clock = &trust_;
    for (const PresentKind& kind : PresentKinds()) {
      SCOPED_TRACE(kind.name);
      trust_.Set(true);
      Fresh(rules);
      numbers_ = 0;
      test(kind);
    }
  }

  /// An upsert that arrives `at_ms` and expires `expires_ms`, both after Time().
  storage::CommitRecord Upsert(const PresentKind& kind, const std::string& id, std::int64_t at_ms,
                               std::int64_t expires_ms = kLongMs) {
    return At(at_ms, Good(++numbers_, kind.upsert({id, "", kNowMs + expires_ms})));
  }
  storage::CommitRecord Delete(const PresentKind& kind, const std::string& id) {
    return Good(++numbers_, kind.deletion(id));
  }

  std::vector<PresentSeen> Seen(const PresentKind& kind, std::int64_t now_ms,
                                bool include_expired = false) {
    storage::PresentQuery query;
    query.now = Time(now_ms);
    query.include_expired = include_expired;
    return RowsOf(kind.read(store_->reader(), query));
  }
  std::vector<std::string> Ids(const PresentKind& kind, std::int64_t now_ms,
                               bool include_expired = false) {
    std::vector<std::string> ids;
    for (PresentSeen& row : Seen(kind, now_ms, include_expired)) ids.push_back(std::move(row.id));
    return ids;
  }

  /// All rows of all robots, in pages.
  std::size_t Count(const PresentKind& kind) {
    storage::PresentQuery query;
    query.include_expired = true;
    query.rows.page_size = storage::kPageSizeMax;
    std::size_t count = 0;
    do {
      const auto page = kind.read(store_->reader(), query);
      EXPECT_TRUE(page.ok()) << page.status();
      if (!page.ok()) return count;
      count += page->rows.size();
      query.rows.page_token = page->next_token;
    } while (!query.rows.page_token.empty());
    return count;
  }

  /// Vouches for the clock, unless the test says otherwise.
  FakeTrust trust_;
  model::Seq numbers_ = 0;
};

}  // namespace uplink::testing
