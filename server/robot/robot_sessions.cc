#include "server/robot/robot_sessions.h"

#include <algorithm>
#include <utility>

#include "schema/base/check.h"
#include "server/robot/mutation.h"

namespace uplink::robot {

RobotSessions::Numbering* RobotSessions::Find(const model::SessionId& session) {
  const auto found = sessions_.find(session);
  return found == sessions_.end() ? nullptr : &found->second;
}

const RobotSessions::Numbering* RobotSessions::Find(const model::SessionId& session) const {
  const auto found = sessions_.find(session);
  return found == sessions_.end() ? nullptr : &found->second;
}

bool RobotSessions::MakeRoom() {
  if (sessions_.size() < kSessionsMax) return true;
  auto oldest = sessions_.end();
  for (auto it = sessions_.begin(); it != sessions_.end(); ++it) {
    if (it->second.window.waiting() > 0) continue;
    if (oldest == sessions_.end() || it->second.last_used < oldest->second.last_used) oldest = it;
  }
  if (oldest == sessions_.end()) return false;
  sessions_.erase(oldest);
  return true;
}

std::optional<RobotSessions::Begun> RobotSessions::Begin(const model::SessionId& session,
                                                         SteadyTime now) {
  const std::lock_guard lock(mutex_);
  if (Find(session) == nullptr) {
    if (!MakeRoom()) return std::nullopt;
    sessions_.try_emplace(session);
  }
  sessions_[session].last_used = now;
  current_session_ = session;
  opened_.reset();
  open_wanted_ = true;
  return Begun{.open_id = ++open_id_, .generation = generation_.load()};
}

std::vector<model::SessionId> RobotSessions::Held() const {
  const std::lock_guard lock(mutex_);
  std::vector<model::SessionId> held;
  held.reserve(sessions_.size());
  for (const auto& [id, numbering] : sessions_) held.push_back(id);
  return held;
}

bool RobotSessions::Opened(std::uint64_t open_id) const {
  const std::lock_guard lock(mutex_);
  return open_id == open_id_ && opened_.has_value();
}

Resume RobotSessions::ResumeFrom(const model::SessionId& session, std::uint64_t open_id,
                                 model::Seq settled_seq, model::Seq judged_seq) {
  const std::lock_guard lock(mutex_);
  Numbering* numbering = Find(session);
  if (numbering == nullptr) return {.committed = settled_seq, .rejects = {}};
  std::map<model::Seq, model::Rejection> rejects;
  const auto add = [&](const RejectedSeq& rejected) {
    if (rejected.seq > settled_seq) rejects.try_emplace(rejected.seq, rejected.rejection);
  };
  for (const RejectedSeq& rejected : numbering->remembered) add(rejected);
  for (const RejectedSeq& rejected : numbering->untold) add(rejected);
  numbering->untold.clear();

  model::Seq committed = settled_seq;
  if (numbering->known) committed = std::max(committed, numbering->window.through());
  if (open_id == open_id_ && opened_) {
    for (storage::StoredReject& stored : opened_->rejects) {
      const RejectedSeq rejected{.seq = stored.seq, .rejection = std::move(stored.rejection)};
      add(rejected);
      RememberIn(*numbering, rejected);
    }
    if (opened_->rejects_complete) committed = std::max(committed, opened_->cursor);
    opened_.reset();
  }
  open_wanted_ = false;
  numbering->known = true;
  numbering->window.Raise(committed);
  numbering->missing_floor = std::max({numbering->missing_floor, committed, judged_seq});
  numbering->hello_judged = std::max(numbering->hello_judged, judged_seq);

  Resume resume{.committed = committed, .rejects = {}};
  if (Planted(Mutation::kRejectNotRepeated)) return resume;
  for (auto& [seq, rejection] : rejects) {
    resume.rejects.push_back({.seq = seq, .rejection = std::move(rejection)});
  }
  return resume;
}

RobotSessions::Seen RobotSessions::See(const model::SessionId& session, model::Seq seq) {
  const std::lock_guard lock(mutex_);
  Numbering* numbering = Find(session);
  if (numbering == nullptr) return {.place = Place::kVoid};
  if (seq <= numbering->window.seen()) {
    return {.place = Place::kDuplicate, .waits = numbering->window.Waits(seq)};
  }
  Seen seen;
  const model::Seq floor = std::max(numbering->window.seen(), numbering->missing_floor);
  if (seq > floor + 1) {
    seen.missing_first = floor + 1;
    seen.missing_last = seq - 1;
    numbering->missing += seq - 1 - floor;
  }
  return seen;
}

void RobotSessions::AddSettled(const model::SessionId& session, model::Seq seq) {
  const std::lock_guard lock(mutex_);
  if (Numbering* numbering = Find(session)) numbering->window.AddSettled(seq);
}

std::int64_t RobotSessions::AddWaiting(const model::SessionId& session, model::Seq seq) {
  const std::lock_guard lock(mutex_);
  Numbering* numbering = Find(session);
  if (numbering == nullptr) return 0;
  const std::size_t before = numbering->window.waiting();
  numbering->window.AddWaiting(seq);
  const std::size_t grew = numbering->window.waiting() - before;
  in_flight_.fetch_add(grew);
  return static_cast<std::int64_t>(grew);
}

void RobotSessions::RememberIn(Numbering& numbering, RejectedSeq rejected) {
  const auto at =
      std::ranges::lower_bound(numbering.remembered, rejected.seq, {}, &RejectedSeq::seq);
  if (at != numbering.remembered.end() && at->seq == rejected.seq) return;
  numbering.remembered.insert(at, std::move(rejected));
  if (numbering.remembered.size() > kRejectsRememberedMax) numbering.remembered.pop_front();
}

void RobotSessions::Remember(const model::SessionId& session, model::Seq seq,
                             const model::Rejection& rejection) {
  const std::lock_guard lock(mutex_);
  if (Numbering* numbering = Find(session)) {
    RememberIn(*numbering, {.seq = seq, .rejection = rejection});
  }
}

void RobotSessions::AddGap() { gaps_in_flight_.fetch_add(1); }

bool RobotSessions::KeepPayload(model::RejectReason reason, SteadyTime now) {
  const std::lock_guard lock(mutex_);
  std::optional<SteadyTime>& kept = payload_kept_[static_cast<std::size_t>(reason)];
  if (kept && now - *kept < std::chrono::seconds(1)) return false;
  kept = now;
  return true;
}

bool RobotSessions::MayNotice(const std::string& field, SteadyTime now) {
  std::string path;
  bool in_index = false;
  for (const char c : field) {
    if (c == ']') in_index = false;
    if (!in_index) path += c;
    if (c == '[') in_index = true;
  }
  const std::lock_guard lock(mutex_);
  // Past the bound all further fields share one slot, so that a robot cannot grow the map.
  if (noticed_.size() >= kNoticeFieldsMax && !noticed_.contains(path)) path.clear();
  const auto [at, first] = noticed_.try_emplace(std::move(path), now);
  if (!first && now - at->second < std::chrono::seconds(1)) return false;
  at->second = now;
  return true;
}

Progress RobotSessions::Take(const model::SessionId& session) {
  const std::lock_guard lock(mutex_);
  Numbering* numbering = Find(session);
  if (numbering == nullptr) return {};
  const AckWindow& window = numbering->window;
  return {.through = Planted(Mutation::kAckBeforeCommit) ? window.seen() : window.through(),
          .judged = std::max(window.seen(), numbering->hello_judged),
          .rejects = std::exchange(numbering->untold, {}),
          .released = std::exchange(numbering->released, {})};
}

std::size_t RobotSessions::waiting(const model::SessionId& session) const {
  const std::lock_guard lock(mutex_);
  const Numbering* numbering = Find(session);
  return numbering == nullptr ? 0 : numbering->window.waiting();
}

SessionView RobotSessions::View() const {
  const std::lock_guard lock(mutex_);
  SessionView view;
  view.connected = static_cast<bool>(current_);
  view.connected_since = connected_since_;
  view.contested = contested_;
  if (!current_session_) return view;
  if (const Numbering* numbering = Find(*current_session_)) {
    view.session = current_session_;
    view.settled_seq = numbering->window.through();
    view.missing = numbering->missing;
  }
  return view;
}

void RobotSessions::Sweep(SteadyTime now, milliseconds idle) {
  const std::lock_guard lock(mutex_);
  std::erase_if(sessions_, [&](const auto& item) {
    const bool has_stream = current_ && current_session_ == item.first;
    return !has_stream && item.second.window.waiting() == 0 && now - item.second.last_used > idle;
  });
  while (!takeovers_.empty() && now - takeovers_.front() > std::chrono::minutes(1)) {
    takeovers_.pop_front();
  }
  contested_ = takeovers_.size() > kTakeoversPerMinuteMax;
}

}  // namespace uplink::robot
