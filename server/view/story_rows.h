#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include <absl/status/status.h>

#include "server/view/story.h"
#include "server/view/story_token.h"
#include "storage/reader.h"

namespace uplink::view {

/// Rows of a list that are read at a time.
inline constexpr std::uint32_t kStoryChunkRows = 100;

/// The rows of one list that a story takes, in its order, read in chunks as they are needed.
/// Confined to one thread; the reader outlives it.
template <typename Row, typename Query, StoryKind kKind, storage::PageKind kList>
class StoryRows final {
 public:
  static constexpr StoryKind kTells = kKind;

  /// `after`: the walk goes on behind it; nothing: it begins.
  StoryRows(storage::Reader& reader, storage::ListOfReader<Row, Query> list,
            const StoryQuery& story, const std::optional<StoryPlace>& after)
      : reader_(reader), list_(list) {
    rows_.ruris = {story.ruri};
    rows_.fleets = story.fleets;
    rows_.from = story.from;
    rows_.to = story.to;
    rows_.order = story.order;
    rows_.page_size = std::min(story.page_size, kStoryChunkRows);
    if (after) rows_.page_token = ListTokenAfter(kList, kKind, story.order, *after);
  }

  /// Before each place(): reads on if it has to.
  [[nodiscard]] absl::Status Fill() {
    if (next_ < chunk_.rows.size() || over_) return absl::OkStatus();
    Query query;
    storage::HistoryQuery& rows = RowsOf(query);
    rows = rows_;
    auto chunk = (reader_.*list_)(query);
    if (!chunk.ok()) return chunk.status();
    chunk_ = *std::move(chunk);
    next_ = 0;
    rows_.page_token = chunk_.next_token;
    over_ = chunk_.next_token.empty();
    return absl::OkStatus();
  }
  /// Of the next row; nothing: there is none.
  [[nodiscard]] std::optional<StoryPlace> place() const {
    if (next_ >= chunk_.rows.size()) return std::nullopt;
    const storage::PagePosition& position = chunk_.positions[next_];
    return StoryPlace{.at = position.at, .kind = kKind, .entry = position.entry};
  }
  [[nodiscard]] Row Take() { return std::move(chunk_.rows[next_++]); }

 private:
  [[nodiscard]] static storage::HistoryQuery& RowsOf(storage::HistoryQuery& query) { return query; }
  template <typename Asked>
  [[nodiscard]] static storage::HistoryQuery& RowsOf(Asked& query) {
    return query.rows;
  }

  storage::Reader& reader_;
  const storage::ListOfReader<Row, Query> list_;
  storage::HistoryQuery rows_;
  storage::Page<Row> chunk_;
  std::size_t next_ = 0;
  /// No chunk follows this one.
  bool over_ = false;
};

}  // namespace uplink::view
