#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/fleet/live_source.h"

namespace uplink::journal {

/// Gives the rows that a test names, one per call; a round ends where none is left.
class ListedRows final : public fleet::LiveSource {
 public:
  void BeginRound() override {
    ++rounds;
    left_ = std::exchange(rows, {});
  }
  std::vector<storage::LiveRow> TakeChanged(std::size_t rows_max) override {
    rows_max_asked.push_back(rows_max);
    if (left_.empty()) return {};
    std::vector<storage::LiveRow> first = {left_.front()};
    left_.pop_front();
    return first;
  }
  void PutBack(std::span<const storage::LiveRow> given) override {
    put_back += given.size();
    rows.insert(rows.end(), given.begin(), given.end());
  }
  void PassedOver(const storage::LiveRow& row) override { passed_over.push_back(row.ruri); }
  /// Of a robot's first hold.
  void Add(const std::string& ruri) { rows.push_back({.ruri = ruri, .held_since = 1}); }

  /// Of the next round.
  std::deque<storage::LiveRow> rows;
  std::size_t put_back = 0;
  std::vector<std::string> passed_over;
  std::vector<std::size_t> rows_max_asked;
  int rounds = 0;

 private:
  std::deque<storage::LiveRow> left_;
};

}  // namespace uplink::journal
