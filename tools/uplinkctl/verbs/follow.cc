#include "tools/uplinkctl/verbs/follow.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "schema/base/rfc3339.h"
#include "tools/uplinkctl/show/json_text.h"

namespace uplink::ctl {
namespace {

namespace json = boost::json;

/// Which rows were shown, and from when on it looks again.
///
/// Thread: confined to one thread.
class Follower final {
 public:
  /// `robots` tells which there are, for their short names.
  Follower(const List& list, const CommonFlags& flags, const Screen& screen,
           std::function<std::vector<std::string>()> robots)
      : list_(list),
        flags_(flags),
        screen_(screen),
        robots_(std::move(robots)),
        newest_(screen.clock.System()) {}

  /// Shows those of the rows that were not in the last ones.
  void Take(Rows rows, bool oldest_first) {
    std::unordered_set<std::string> seen;
    json::array fresh;
    for (json::value& row : rows.rows) {
      if (!row.is_object()) continue;
      Note(row.get_object());
      std::string text = LineJson(row);
      if (!seen_.contains(text)) fresh.push_back(std::move(row));
      seen.insert(std::move(text));
    }
    seen_ = std::move(seen);
    // Looking back would read the same rows again, and never those behind them.
    if (oldest_first && rows.more) first_ = newest_;
    if (!fresh.empty()) Show(fresh);
  }

  /// From the time of the newest row, less the overlap, but never before the first row: those
  /// before it were left out by the limit, or are shown.
  [[nodiscard]] SystemTime From() const {
    return std::max(newest_ - kFollowOverlap, first_.value_or(SystemTime::min()));
  }

 private:
  void Note(const json::object& row) {
    const auto time = FromRfc3339(TextAt(row, list_.grows_by));
    if (!time) return;
    if (!first_ || *time < *first_) first_ = time;
    newest_ = has_rows_ ? std::max(newest_, *time) : *time;
    has_rows_ = true;
  }

  void Show(const json::array& rows) {
    std::string text;
    switch (flags_.format()) {
      case Format::kJson:
        for (const json::value& row : rows) text += LineJson(row) + '\n';
        break;
      case Format::kCsv:
        text = CsvOf(list_.columns, rows, headings_);
        break;
      case Format::kTable: {
        RowTerms terms = screen_.Terms();
        terms.table.headings = headings_;
        if (!robots_known_) robots_known_ = robots_();
        terms.robots = *robots_known_;
        text = TableOf(list_.columns, rows, terms);
        break;
      }
    }
    headings_ = false;
    screen_.print(text);
  }

  const List& list_;
  const CommonFlags& flags_;
  const Screen& screen_;
  const std::function<std::vector<std::string>()> robots_;
  /// Asked for once, with the first rows.
  std::optional<std::vector<std::string>> robots_known_;
  std::unordered_set<std::string> seen_;
  std::optional<SystemTime> first_;
  SystemTime newest_;
  bool has_rows_ = false;
  bool headings_ = true;
};

/// The same request for what came since, the oldest first.
Query Since(const Query& query, SystemTime from) {
  Query later;
  for (const auto& parameter : query) {
    if (parameter.first != "from" && parameter.first != "orderBy") later.push_back(parameter);
  }
  later.emplace_back("from", Rfc3339(from));
  later.emplace_back("orderBy", "oldest");
  return later;
}

}  // namespace

bool Grows(const List& list, const Query& query) {
  // Of faults that are active now a row goes when its fault ends.
  return !list.grows_by.empty() &&
         std::ranges::find(query, "active", &Query::value_type::first) == query.end();
}

absl::Status FollowRows(const List& list, const ListFlags& flags, const Query& query, Api& api,
                        const Screen& screen) {
  const std::string path(list.path);
  const std::string member(list.member);
  absl::StatusOr<Rows> rows = api.List(path, member, query, static_cast<std::size_t>(flags.limit));
  if (!rows.ok()) return rows.status();
  if (!flags.oldest) std::ranges::reverse(rows->rows);
  Follower follower(list, flags.common, screen,
                    [&] { return NamedBeside(list, flags.common, api); });
  follower.Take(*std::move(rows), flags.oldest);
  while (screen.wait()) {
    rows = api.List(path, member, Since(query, follower.From()), kFollowRowsMax);
    if (!rows.ok()) {
      screen.note(std::string(rows.status().message()));
      continue;
    }
    follower.Take(*std::move(rows), true);
  }
  return absl::OkStatus();
}

}  // namespace uplink::ctl
