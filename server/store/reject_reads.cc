#include "server/store/reject_reads.h"

namespace uplink::store {

bool RejectReads::Read(const storage::RejectsQuery& query, Done done) {
  return post_([this, query, done = std::move(done)] { done(reader_.Rejects(query)); });
}

}  // namespace uplink::store
