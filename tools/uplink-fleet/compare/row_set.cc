#include "tools/uplink-fleet/compare/row_set.h"

#include <utility>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

std::uint64_t Sum(std::uint64_t a, std::uint64_t b) {
  return a > kAnyTimes - b ? kAnyTimes : a + b;
}

std::string AtMost(std::uint64_t times) {
  return times == 0 ? "no more" : times == 1 ? "once" : fmt::format("{} times at most", times);
}

}  // namespace

RowSet::RowSet(Thing thing, std::string ruri, Findings& findings)
    : thing_(thing), ruri_(std::move(ruri)), findings_(findings) {}

void RowSet::Expect(const std::string& key, ExpectedRow row) {
  findings_.Expect(thing_, row.times.min);
  const auto [at, fresh] = rows_.try_emplace(key);
  Times& times = row.times;
  if (!fresh) {
    times.min = Sum(times.min, at->second.expected.times.min);
    times.max = Sum(times.max, at->second.expected.times.max);
  }
  at->second.expected = std::move(row);
}

bool RowSet::Find(const std::string& key, std::uint64_t content,
                  const std::function<std::string()>& shown) {
  findings_.Find(thing_);
  const auto at = rows_.find(key);
  if (at == rows_.end()) {
    findings_.Differ(thing_, ruri_, "nothing like it", shown());
    return false;
  }
  const ExpectedRow& expected = at->second.expected;
  const std::uint64_t times = ++at->second.found;
  if (times > expected.times.max) {
    findings_.Differ(thing_, ruri_,
                     fmt::format("{}: {}", expected.shown, AtMost(expected.times.max)),
                     fmt::format("{} times: {}", times, shown()));
  } else if (expected.content != 0 && expected.content != content) {
    findings_.Differ(thing_, ruri_, expected.shown, shown());
  }
  // One that may be there: it is expected now.
  if (times > expected.times.min && times <= expected.times.max) findings_.Expect(thing_);
  return times == 1;
}

void RowSet::Finish(std::uint64_t dropped) {
  std::uint64_t missing = 0;
  for (const auto& [key, row] : rows_) missing += row.found < row.expected.times.min ? 1 : 0;
  if (missing <= dropped) return findings_.Find(thing_, missing);
  for (const auto& [key, row] : rows_) {
    if (row.found >= row.expected.times.min) continue;
    findings_.Differ(thing_, ruri_, row.expected.shown, "no such row");
  }
}

bool RowSet::Found(const std::string& key) const {
  const auto at = rows_.find(key);
  return at != rows_.end() && at->second.found > 0;
}

}  // namespace uplink::synthetic
