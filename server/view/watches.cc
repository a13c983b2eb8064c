#include "server/view/watches.h"

#include <mutex>
#include <optional>
#include <utility>

#include "server/view/json.h"
#include "server/view/watch_book.h"

namespace uplink::view {
namespace {

/// A watch of a book.
class BookedWatch final : public Watch {
 public:
  BookedWatch(std::shared_ptr<WatchBook> book, std::shared_ptr<WatchBook::Entry> entry)
      : book_(std::move(book)), entry_(std::move(entry)) {}
  ~BookedWatch() override { book_->End(entry_, why_); }
  BookedWatch(const BookedWatch&) = delete;
  BookedWatch& operator=(const BookedWatch&) = delete;

  absl::StatusOr<std::vector<WatchChange>> Take() override { return book_->Take(*entry_); }
  void NoteEnd(WatchEnd why) override { why_ = why; }

 private:
  const std::shared_ptr<WatchBook> book_;
  const std::shared_ptr<WatchBook::Entry> entry_;
  WatchEnd why_ = WatchEnd::kLeft;
};

}  // namespace

struct WatchedRobot::Text {
  std::once_flag once;
  std::optional<absl::StatusOr<std::string>> json;
};

WatchedRobot::WatchedRobot(RobotView view, const PartSet& parts)
    : view_(std::move(view)), parts_(parts), text_(std::make_unique<Text>()) {}

WatchedRobot::~WatchedRobot() = default;

const absl::StatusOr<std::string>& WatchedRobot::json() const {
  std::call_once(text_->once, [this] { text_->json = ToJson(view_, parts_); });
  return *text_->json;
}

Watches::Watches(const Context& context) : book_(std::make_shared<WatchBook>(context)) {}

absl::StatusOr<std::unique_ptr<Watch>> Watches::Begin(WatchQuery query,
                                                      std::function<void()> ready) {
  auto entry = book_->Begin(std::move(query), std::move(ready));
  if (!entry.ok()) return entry.status();
  return std::make_unique<BookedWatch>(book_, *std::move(entry));
}

void Watches::Sweep() { book_->Sweep(); }

void Watches::Stop() { book_->Stop(); }

std::size_t Watches::size() const { return book_->size(); }

}  // namespace uplink::view
