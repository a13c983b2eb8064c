#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "schema/base/check.h"
#include "schema/model/presence.h"
#include "storage/reader.h"

namespace uplink::simulation {

/// Every row of one robot that `read` gives, page by page.
template <typename Row, typename Read>
std::vector<Row> AllRows(const std::string& ruri, const Read& read) {
  std::vector<Row> rows;
  storage::HistoryQuery query{.ruris = {ruri}, .page_size = storage::kPageSizeMax};
  do {
    auto page = read(query);
    UPLINK_CHECK(page.ok(), page.status().ToString());
    for (Row& row : page->rows) rows.push_back(std::move(row));
    query.page_token = page->next_token;
  } while (!query.page_token.empty());
  return rows;
}

/// Whether the rows, newest first, are the changes, oldest first; text: what differs.
std::optional<std::string> ComparePresence(const std::string& ruri,
                                           const std::vector<storage::PresenceRow>& rows,
                                           const std::vector<model::Presence>& changes);

}  // namespace uplink::simulation
