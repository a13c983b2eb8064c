#include "tests/unit/server/session/threads_worker.h"

namespace uplink::session {

void ThreadsWorker::Start(ThreadsWorker& partner) {
  partner_ = &partner;
  thread_ = std::thread([this] { Run(); });
}

void ThreadsWorker::Connect() {
  const std::lock_guard lock(mutex_);
  signals_.connect = true;
  changed_.notify_one();
}

void ThreadsWorker::Wake(std::uint64_t stream) {
  const std::lock_guard lock(mutex_);
  if (stream != id_) return;
  signals_.wake = true;
  changed_.notify_one();
}

void ThreadsWorker::Stop() {
  {
    const std::lock_guard lock(mutex_);
    signals_.stop = true;
    changed_.notify_one();
  }
  if (thread_.joinable()) thread_.join();
}

void ThreadsWorker::Run() {
  bool busy = false;
  while (true) {
    const Signals signals = Next(busy);
    if (signals.stop) break;
    if (signals.connect) {
      Open();
    } else if (signals.wake && stream_ && !stream_->session().done()) {
      stream_->session().OnWake();
    }
    if (stream_) {
      const auto deadline = stream_->session().deadline();
      if (deadline && *deadline <= core_.clock.Steady()) stream_->session().OnTimer();
    }
    busy = stream_ && Step();
  }
  if (stream_) stream_->session().OnBroken();
  stream_.reset();
}

ThreadsWorker::Signals ThreadsWorker::Next(bool busy) {
  const auto deadline = stream_ ? stream_->session().deadline() : std::nullopt;
  const auto any = [this] { return signals_.any(); };
  std::unique_lock lock(mutex_);
  if (!busy && deadline) {
    changed_.wait_until(lock, *deadline, any);
  } else if (!busy) {
    changed_.wait(lock, any);
  }
  const bool stop = signals_.stop;
  return std::exchange(signals_, Signals{.stop = stop});
}

void ThreadsWorker::Open() {
  if (stream_) stream_->session().OnBroken();
  stream_.reset();
  const std::uint64_t id = core_.next_stream.fetch_add(1);
  const auto hello = agent_.Connect(id);
  if (!hello) return;
  {
    const std::lock_guard lock(mutex_);
    id_ = id;
    signals_.wake = false;
  }
  stream_id_ = id;
  const SessionContext context{.clock = core_.clock,
                               .fleet = core_.fleet,
                               .journals = core_.shards,
                               .probe = core_.probe,
                               .ledger = ledger_,
                               .judge = judge_,
                               .limits = core_.limits.session,
                               .scratch = scratch_,
                               .allowances = allowances_,
                               .rejects = core_.rejects,
                               .clock_trust = clock_trust_};
  stream_ = std::make_unique<ThreadsStream>(context, agent_.ruri(),
                                            loop::StreamRef{.inbox = this, .stream = id});
  stream_->session().Start();
  stream_->Send(*hello);
}

bool ThreadsWorker::Step() {
  if (const auto frame = stream_->TakeWritten()) {
    agent_.OnFrame(stream_id_, *frame);
    if (!stream_->session().done()) stream_->session().OnWritten();
    return true;
  }
  if (const auto end = stream_->TakeEnd()) {
    stream_.reset();
    if (agent_.OnEnd(stream_id_, *end)) Open();
    return true;
  }
  return stream_->reading() && Give(agent_.Ask(stream_id_));
}

bool ThreadsWorker::Give(const Move& move) {
  switch (move.kind) {
    case Move::Kind::kWait:
      return false;
    case Move::Kind::kHalfClose:
      stream_->HalfClose();
      return true;
    case Move::Kind::kSend:
      break;
  }
  stream_->Send(move.frame);
  if (move.then == Move::Then::kBreak) Open();
  if (move.then == Move::Then::kTakeOver) partner_->Connect();
  return true;
}

}  // namespace uplink::session
