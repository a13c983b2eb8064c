#include "server/robot/progress.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "server/robot/mutation.h"

namespace uplink::robot {

Progress TakeProgress(SessionMemory& memory) {
  const Numbering& numbers = memory.numbers;
  const model::Seq through =
      Planted(Mutation::kAckBeforeCommit) ? numbers.seen() : numbers.through();
  // An Ack covers no Reject that was not reported, neither as settled nor as judged.
  const bool awaits = !Planted(Mutation::kPagesNotAwaited);
  const model::Seq told = memory.rejects.told_through().value_or(through);
  const auto judged = memory.rejects.judged_through(memory.known_judged);
  return {.through = awaits ? std::min(through, told) : through,
          .judged = std::min(numbers.judged(), judged.value_or(numbers.judged())),
          .rejects = memory.rejects.TakeUntold(),
          .released = std::exchange(memory.released, {})};
}

Resume ResumeOf(SessionMemory& memory, OpenAnswer& open_answer, const ResumeFor& hello) {
  memory.known_judged = hello.judged_seq;
  std::optional<storage::OpenResult> answer = open_answer.Take(hello.open_id);
  const bool answered = answer.has_value();
  StoredSession stored = StoredOf(std::move(answer));
  std::vector<RejectedSeq> rejects =
      memory.rejects.RepeatForWelcome(hello.settled_seq, std::move(stored.rejects));
  if (answered) memory.rejects.SetComplete();
  // The store may have gone back since it confirmed commits: the agent keeps its messages until the
  // store has answered.
  const model::Seq told = Planted(Mutation::kReconnectTrusted) ? 0 : memory.committed;
  const bool awaits =
      !answered && memory.rejects.AwaitLate(hello.settled_seq, hello.judged_seq, told);
  if (awaits) open_answer.WantLate();
  if (answered) memory.rejects.BeginPages(stored.unread, stored.more);
  Resume resume{
      .committed = memory.numbers.Resume(hello.settled_seq, hello.judged_seq, stored.through),
      .rejects = std::move(rejects)};
  if (awaits && told > hello.settled_seq)
    resume.committed = std::min(resume.committed, hello.settled_seq);
  if (Planted(Mutation::kRejectNotRepeated)) resume.rejects.clear();
  return resume;
}

}  // namespace uplink::robot
