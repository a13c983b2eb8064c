#include "server/session/reject_pages.h"

#include "server/session/reject_source.h"

namespace uplink::session {

bool RejectPages::Collect() {
  if (asked_ == nullptr) return false;
  std::optional<Page> page = asked_->Take();
  if (!page) return false;
  asked_.reset();
  if (!page->ok()) {
    sources_.context.probe.reject_reads_failed_total.Add();
    SetTry();
    return false;
  }
  sources_.context.probe.reject_pages_total.Add();
  const bool last = (*page)->size() < query_.rows_max;
  const model::Seq through = last ? query_.through : (*page)->back().seq;
  sources_.robot.AddPage(**std::move(page), through);
  return true;
}

void RejectPages::SetTry() {
  sources_.timers.Set(Timer::kReadRejects, sources_.context.clock.Steady() + kRejectsReadAgain);
}

void RejectPages::Ask(std::size_t outgoing) {
  if (sources_.timers.is_set(Timer::kReadRejects)) {
    if (!sources_.timers.Due(Timer::kReadRejects, sources_.context.clock.Steady())) return;
    sources_.timers.Clear(Timer::kReadRejects);
  }
  if (asked_ != nullptr || outgoing > 0) return;
  const std::optional<robot::UnreadRejects> unread = sources_.robot.Unread();
  if (!unread) return;
  query_ = {.ruri = sources_.robot.robot().ruri(),
            .session = sources_.robot.session(),
            .above = unread->after,
            .through = unread->through,
            .rows_max = sources_.context.limits.reject_page_max};
  auto box = std::make_shared<Box>();
  const bool taken =
      sources_.context.rejects.Read(query_, [box, stream = sources_.robot.self()](Page page) {
        box->Put(std::move(page));
        stream.Wake();
      });
  if (taken) {
    asked_ = std::move(box);
  } else {
    sources_.context.probe.reject_reads_failed_total.Add();
    SetTry();
  }
}

}  // namespace uplink::session
