#include "server/view/watch_marks.h"

#include <bit>
#include <utility>

namespace uplink::view {

void NumberSet::Add(std::size_t number) {
  if (number / kBits >= words_.size()) words_.resize(number / kBits + 1);
  std::uint64_t& word = words_[number / kBits];
  const std::uint64_t bit = std::uint64_t{1} << (number % kBits);
  if ((word & bit) == 0) ++size_;
  word |= bit;
}

bool NumberSet::Remove(std::size_t number) {
  if (number / kBits >= words_.size()) return false;
  std::uint64_t& word = words_[number / kBits];
  const std::uint64_t bit = std::uint64_t{1} << (number % kBits);
  if ((word & bit) == 0) return false;
  word &= ~bit;
  --size_;
  return true;
}

std::optional<std::size_t> NumberSet::NextFrom(std::size_t first) const {
  for (std::size_t at = first / kBits; at < words_.size(); ++at) {
    std::uint64_t word = words_[at];
    if (at == first / kBits) word &= ~std::uint64_t{0} << (first % kBits);
    if (word != 0) return at * kBits + static_cast<std::size_t>(std::countr_zero(word));
  }
  return std::nullopt;
}

void WatchMarks::Hide(std::size_t robot, std::string_view ruri) {
  due_.Remove(robot);
  if (shown_.Remove(robot)) removed_.emplace_back(ruri);
}

std::optional<std::string> WatchMarks::TakeRemoved() {
  if (removed_.empty()) return std::nullopt;
  // Which of them goes first does not matter: none comes again before all are told.
  std::string ruri = std::move(removed_.back());
  removed_.pop_back();
  return ruri;
}

std::optional<std::size_t> WatchMarks::TakeRobot() {
  std::optional<std::size_t> robot = due_.NextFrom(next_);
  // The end of the snapshot is told before the second circle.
  if (!robot && !in_snapshot_) robot = due_.NextFrom(0);
  if (!robot) return std::nullopt;
  next_ = *robot + 1;
  due_.Remove(*robot);
  shown_.Add(*robot);
  if (in_snapshot_) ++in_first_circle_;
  return robot;
}

void WatchMarks::PutBack(std::size_t robot) {
  due_.Add(robot);
  next_ = robot;
  if (in_snapshot_) --in_first_circle_;
}

std::optional<std::int64_t> WatchMarks::TakeSnapshotEnd() {
  if (!in_snapshot_ || due_.NextFrom(next_)) return std::nullopt;
  in_snapshot_ = false;
  next_ = 0;
  return in_first_circle_;
}

}  // namespace uplink::view
