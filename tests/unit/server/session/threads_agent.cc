#include "tests/unit/server/session/threads_agent.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace uplink::session {
namespace {

/// Messages of one batch.
constexpr std::uint64_t kBatchMax = 6;

}  // namespace

std::optional<v1::RelayRequest> ThreadsAgent::Connect(std::uint64_t stream) {
  const std::lock_guard lock(mutex_);
  if (finished_) return std::nullopt;
  ++connects_;
  ChooseSession();
  active_ = stream;
  welcomed_ = false;
  half_closed_ = false;
  through_ = 0;
  judged_ = 0;
  resend_.clear();
  unrejected_.clear();
  const Numbering& it = Current();
  return HelloFrame(it.id, it.settled, std::max(it.judged, it.settled));
}

void ThreadsAgent::ChooseSession() {
  const auto keeps = [](const Numbering& it) { return !it.kept.empty(); };
  const auto first = std::ranges::find_if(sessions_, keeps);
  // A new numbering may begin while records of older ones still wait.
  const bool may_begin = sent_ < messages_max_ && std::ranges::count_if(sessions_, keeps) < 3;
  if (sessions_.empty() || (may_begin && Percent(25))) {
    session_ = sessions_.size();
    sessions_.push_back({.id = SessionOf(static_cast<std::uint8_t>(session_ + 1))});
  } else if (first != sessions_.end()) {
    session_ = static_cast<std::size_t>(first - sessions_.begin());
  }
}

Move ThreadsAgent::Ask(std::uint64_t stream) {
  const std::lock_guard lock(mutex_);
  if (stream != active_ || !welcomed_ || half_closed_) return {};
  std::vector<Message> messages;
  const std::uint64_t size = 1 + random_() % kBatchMax;
  while (messages.size() < size && (!resend_.empty() || sent_ < messages_max_)) {
    if (resend_.empty()) {
      messages.push_back(Fresh());
      continue;
    }
    const model::Seq seq = *resend_.begin();
    resend_.erase(resend_.begin());
    messages.push_back({seq, *Current().kept.at(seq)});
  }
  Move move;
  if (!messages.empty()) {
    move = {.kind = Move::Kind::kSend, .frame = BatchFrame(messages)};
    // Only while something is left to send, so that there is an end.
    if (sent_ < messages_max_ && Percent(6)) {
      move.then = Percent(50) ? Move::Then::kBreak : Move::Then::kTakeOver;
    }
  } else if (Current().kept.empty()) {
    half_closed_ = true;
    move.kind = Move::Kind::kHalfClose;
  }
  return move;
}

void ThreadsAgent::OnFrame(std::uint64_t stream, const v1::RelayResponse& frame) {
  const std::lock_guard lock(mutex_);
  if (stream != active_) return;
  switch (frame.frame_case()) {
    case v1::RelayResponse::kWelcome:
      return OnWelcome(frame.welcome().committed_seq());
    case v1::RelayResponse::kAck:
      return OnAck(frame.ack());
    case v1::RelayResponse::kReject:
      EXPECT_TRUE(welcomed_) << ruri_;
      Current().told.insert(frame.reject().seq());
      unrejected_.erase(frame.reject().seq());
      return;
    case v1::RelayResponse::kResendRequest:
      return;  // it has none of these
    default:
      ADD_FAILURE() << ruri_ << ": " << ToLine(frame);
  }
}

bool ThreadsAgent::OnEnd(std::uint64_t stream, const absl::Status& status) {
  const std::lock_guard lock(mutex_);
  const bool superseded = absl::IsAborted(status) && connects_ > 1;
  EXPECT_TRUE(superseded || status.ok()) << ruri_ << ": " << status.ToString();
  if (stream != active_) return false;
  EXPECT_TRUE(superseded || half_closed_) << ruri_;
  finished_ = sent_ == messages_max_ && KeepsNothing();
  return !finished_;
}

bool ThreadsAgent::KeepsNothing() const {
  return std::ranges::all_of(sessions_, [](const Numbering& it) { return it.kept.empty(); });
}

bool ThreadsAgent::finished() const {
  const std::lock_guard lock(mutex_);
  return finished_;
}

void ThreadsAgent::CheckStore() const {
  const std::lock_guard lock(mutex_);
  for (const Numbering& it : sessions_) {
    const testing::SessionLog log = database_.Log(ruri_, it.id);
    EXPECT_TRUE(std::ranges::equal(log.stored, it.good)) << ruri_;
    for (const model::Seq seq : it.bad) EXPECT_TRUE(log.quarantined.contains(seq)) << seq;
    for (const auto& [seq, rejection] : log.quarantined) {
      EXPECT_TRUE(it.bad.contains(seq) || it.bad_live.contains(seq)) << seq;
    }
    for (const auto& [seq, times] : log.times_written) EXPECT_EQ(times, 1U) << seq;
  }
}

std::string ThreadsAgent::State() const {
  const std::lock_guard lock(mutex_);
  std::string text = fmt::format(
      "{}: sent {}, connects {}, stream {}, welcomed {}, half-closed {}, ack {} judged {}", ruri_,
      sent_, connects_, active_, welcomed_, half_closed_, through_, judged_);
  for (const Numbering& it : sessions_) {
    if (!it.kept.empty()) text += fmt::format(", kept from {}", it.kept.begin()->first);
  }
  return text;
}

Message ThreadsAgent::Fresh() {
  static const std::string kGood = Fault();
  static const std::string kBad = BadFault();
  static const std::string kLive = Motion();
  static const std::string kBadLive = kLive.substr(0, 20);
  Numbering& it = Current();
  ++sent_;
  if (Percent(3)) it.next += 1 + random_() % 3;
  const model::Seq seq = it.next++;
  const std::uint64_t pick = random_() % 100;
  if (pick < 25) return {seq, kLive};
  if (pick < 45) unrejected_.insert(seq);
  if (pick < 35) {
    it.bad_live.insert(seq);
    return {seq, kBadLive};
  }
  (pick < 45 ? it.bad : it.good).insert(seq);
  const std::string& payload = pick < 45 ? kBad : kGood;
  it.kept.emplace(seq, &payload);
  return {seq, payload};
}

void ThreadsAgent::OnWelcome(model::Seq committed) {
  EXPECT_FALSE(welcomed_) << ruri_;
  welcomed_ = true;
  Numbering& it = Current();
  EXPECT_GE(committed, it.settled) << ruri_;
  for (const auto& [seq, payload] : it.kept) {
    if (seq > committed) resend_.insert(seq);
  }
}

void ThreadsAgent::OnAck(const v1::Ack& ack) {
  EXPECT_TRUE(welcomed_) << ruri_;
  EXPECT_GE(ack.through_seq(), through_) << ruri_ << ": an Ack went back";
  EXPECT_GE(ack.judged_seq(), judged_) << ruri_ << ": an Ack went back";
  Numbering& it = Current();
  EXPECT_LT(ack.judged_seq(), it.next) << ruri_;
  if (!unrejected_.empty()) {
    EXPECT_GT(*unrejected_.begin(), ack.judged_seq()) << ruri_ << ": an Ack before its Reject";
  }
  through_ = ack.through_seq();
  judged_ = ack.judged_seq();
  it.settled = std::max(it.settled, through_);
  it.judged = std::max(it.judged, judged_);
  while (!it.kept.empty() && it.kept.begin()->first <= through_) {
    const model::Seq seq = it.kept.begin()->first;
    EXPECT_EQ(database_.TimesWritten(ruri_, it.id, seq), 1U) << ruri_ << " " << seq;
    EXPECT_TRUE(!it.bad.contains(seq) || it.told.contains(seq)) << ruri_ << " " << seq;
    it.kept.erase(it.kept.begin());
    resend_.erase(seq);
  }
}

}  // namespace uplink::session
