#include "server/view/brief_look.h"

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <utility>

namespace uplink::view {

struct BriefLook::State {
  std::mutex mutex;
  std::condition_variable ended;
  std::uint64_t begun = 0;
  std::uint64_t last_ended = 0;
  /// A look that has not ended yet took longer than the wait.
  bool slow = false;
};

namespace {

/// Reports the end of a look, also of one that was dropped before it ran.
template <typename End>
class AtEnd final {
 public:
  explicit AtEnd(End end) : end_(std::move(end)) {}
  ~AtEnd() { end_(); }
  AtEnd(const AtEnd&) = delete;
  AtEnd& operator=(const AtEnd&) = delete;

 private:
  const End end_;
};

}  // namespace

BriefLook::BriefLook(Post post, milliseconds wait)
    : post_(std::move(post)), wait_(wait), state_(std::make_shared<State>()) {}

bool BriefLook::Run(std::function<void()> look) {
  if (!post_) {
    look();
    return true;
  }
  std::uint64_t number = 0;
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->slow) return false;
    number = ++state_->begun;
  }
  const auto end = [state = state_, number] {
    {
      const std::lock_guard lock(state->mutex);
      state->last_ended = number;
      state->slow = false;
    }
    state->ended.notify_all();
  };
  auto at_end = std::make_shared<AtEnd<decltype(end)>>(end);
  if (!post_([kept = std::move(at_end), look = std::move(look)] { look(); })) return false;
  std::unique_lock lock(state_->mutex);
  const bool ended =
      state_->ended.wait_for(lock, wait_, [&] { return state_->last_ended >= number; });
  if (!ended) state_->slow = true;
  return ended;
}

}  // namespace uplink::view
