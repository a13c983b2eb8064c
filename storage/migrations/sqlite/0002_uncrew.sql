-- oldest: 1
-- Drones that call (ADR-0121). Names, times and numbers as in 0001.

-- The level of a message as its sender calls it; empty if it says none.
ALTER TABLE messages ADD COLUMN source_level TEXT NOT NULL DEFAULT '';

-- Which process serves a drone's calls, beside the one that holds the robot. A sample that was judged under
-- another epoch is fenced. last_used: when it was claimed, or a sample was stored under it.
CREATE TABLE drone_claims (
  ruri TEXT NOT NULL PRIMARY KEY,
  owner BLOB NOT NULL,
  epoch INTEGER NOT NULL,
  last_used INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

-- The last samples of each type that are stored, so that they are known when they come again. digests:
-- 16 bytes each, the oldest first; last: what the server said with the last one.
CREATE TABLE samples (
  ruri TEXT NOT NULL,
  type INTEGER NOT NULL,
  digests BLOB NOT NULL,
  last BLOB NOT NULL,
  PRIMARY KEY (ruri, type)
) STRICT;

-- Requests of drones to their operators: open ones and those that have ended. requested_ms: by the
-- drone's clock; opened_at, closed_at: arrivals, 0 while it is open. An id that comes again after its
-- end is another row.
CREATE TABLE operator_requests (
  ruri TEXT NOT NULL,
  opened_at INTEGER NOT NULL,
  entry INTEGER NOT NULL,
  fleet TEXT NOT NULL,
  request_id TEXT NOT NULL,
  kind INTEGER NOT NULL,
  text TEXT NOT NULL,
  requested_ms INTEGER NOT NULL,
  is_open INTEGER NOT NULL,
  closed_at INTEGER NOT NULL,
  PRIMARY KEY (ruri, opened_at, entry)
) STRICT;
CREATE UNIQUE INDEX operator_requests_open ON operator_requests (ruri, request_id) WHERE is_open;
CREATE INDEX operator_requests_by_fleet ON operator_requests (fleet, opened_at, entry);
CREATE INDEX operator_requests_by_time ON operator_requests (opened_at, entry);
CREATE INDEX operator_requests_open_by_fleet ON operator_requests (fleet, opened_at, entry)
  WHERE is_open;
CREATE INDEX operator_requests_open_by_time ON operator_requests (opened_at, entry) WHERE is_open;
