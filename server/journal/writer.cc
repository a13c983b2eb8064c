#include "server/journal/writer.h"

#include <condition_variable>
#include <mutex>
#include <utility>

#include <pthread.h>

#include "server/journal/turns.h"

namespace uplink::journal {

JournalWriter::JournalWriter(Journal& journal, const storage::BackoffLimits& backoff,
                             std::function<std::uint64_t()> random)
    : turns_(journal.turns()), backoff_(backoff), random_(std::move(random)) {
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

JournalWriter::~JournalWriter() { Stop(); }

void JournalWriter::Stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void JournalWriter::Run(const std::stop_token& stop) {
  pthread_setname_np(pthread_self(), "journal");
  while (!stop.stop_requested()) {
    switch (turns_.Advance()) {
      case Step::kIdle:
        turns_.WaitForWork(stop);
        break;
      case Step::kWorked:
        backoff_.Reset();
        break;
      case Step::kFailed:
        Pause(stop);
        break;
    }
  }
}

void JournalWriter::Pause(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, stop, backoff_.Next(random_()), [] { return false; });
}

}  // namespace uplink::journal
