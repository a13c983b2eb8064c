-- oldest: 1
-- Drones that call (ADR-0121). Applied as 0001.

-- The level of a message as its sender calls it; empty if it says none.
ALTER TABLE messages ADD COLUMN source_level text NOT NULL DEFAULT '';

-- Which process serves a drone's calls, beside the one that holds the robot. A sample that was judged under
-- another epoch is fenced. Changed only while the robot's row is locked, as all below. last_used: when it
-- was claimed, or a sample was stored under it.
CREATE TABLE drone_claims (
  ruri text COLLATE "C" NOT NULL PRIMARY KEY,
  owner uuid NOT NULL,
  epoch bigint NOT NULL,
  last_used timestamptz NOT NULL
) WITH (fillfactor = 50);

-- The last samples of each type that are stored, so that they are known when they come again. digests:
-- 16 bytes each, the oldest first; last: what the server said with the last one.
CREATE TABLE samples (
  ruri text COLLATE "C" NOT NULL,
  type integer NOT NULL,
  digests bytea NOT NULL,
  last bytea NOT NULL,
  PRIMARY KEY (ruri, type)
) WITH (fillfactor = 50);

-- Requests of drones to their operators: open ones and those that have ended. requested_ms: by the
-- drone's clock; opened_at, closed_at: arrivals, 'epoch' while it is open. An id that comes again after its
-- end is another row.
CREATE TABLE operator_requests (
  ruri text COLLATE "C" NOT NULL,
  opened_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  request_id text COLLATE "C" NOT NULL,
  kind integer NOT NULL,
  text text NOT NULL,
  requested_ms bigint NOT NULL,
  is_open boolean NOT NULL,
  closed_at timestamptz NOT NULL,
  PRIMARY KEY (ruri, opened_at, entry)
) WITH (fillfactor = 75);
CREATE UNIQUE INDEX operator_requests_open ON operator_requests (ruri, request_id) WHERE is_open;
CREATE INDEX operator_requests_by_fleet ON operator_requests (fleet, opened_at, entry);
CREATE INDEX operator_requests_by_time ON operator_requests (opened_at, entry);
CREATE INDEX operator_requests_open_by_fleet ON operator_requests (fleet, opened_at, entry)
  WHERE is_open;
CREATE INDEX operator_requests_open_by_time ON operator_requests (opened_at, entry) WHERE is_open;

-- Raises every sequence above what rows name of it, where it is left behind: logical replication copies
-- rows and no sequences. An entry below its session's first hides a Reject, an epoch that was given before
-- has a holder, and a number of a request that is there already is refused. Returns whether anything was
-- behind. Runs as the owner, since the server's role may draw from a sequence and not set it. Called at each
-- connect, so of a table with an index of times it looks at the newest row alone; where these show that
-- `batches` is behind, it is raised by 2^30 more, for rows that are older by their times.
CREATE OR REPLACE FUNCTION raise_sequences()
RETURNS boolean LANGUAGE plpgsql SECURITY DEFINER SET search_path = uplinkd, pg_temp AS $$
DECLARE
  source record;
  seen bigint;
  batch bigint;
  epoch bigint;
  request bigint;
BEGIN
  -- Neither has an index of times.
  SELECT greatest((SELECT max(s.first_entry) FROM sessions AS s),
                  (SELECT max(k.entry) FROM kept_rejects AS k), 0) INTO batch;
  FOR source IN
    SELECT h.parent, h.arrival, 'entry' AS number FROM histories() AS h
    UNION ALL VALUES ('mission_runs', 'first_at', 'last_entry'), ('mission_runs', 'first_at', 'entry'),
      ('faults_active', 'raised_at', 'entry'), ('shapes', 'first_at', 'entry'),
      ('objects', 'first_at', 'entry'), ('gaps', 'seen_at', 'entry'),
      ('operator_requests', 'opened_at', 'entry')
  LOOP
    EXECUTE format('SELECT %I FROM %I ORDER BY %I DESC, entry DESC LIMIT 1',
                   source.number, source.parent, source.arrival) INTO seen;
    batch := greatest(batch, seen);
  END LOOP;
  batch := batch >> 20;
  SELECT greatest((SELECT max(r.epoch) FROM robots AS r), (SELECT max(l.held_since) FROM live AS l),
                  (SELECT max(c.epoch) FROM topic_clients AS c),
                  (SELECT max(d.epoch) FROM drone_claims AS d), 0) INTO epoch;
  SELECT coalesce(max(f.number), 0) INTO request FROM forget_requests AS f;
  -- What each gives next.
  IF batch < (SELECT last_value + is_called::int FROM batches)
    AND epoch < (SELECT last_value + is_called::int FROM epochs)
    AND request < (SELECT last_value + is_called::int FROM forget_requests_number_seq) THEN
    RETURN false;
  END IF;
  -- One at a time, so that no later call takes back what an earlier one gave.
  PERFORM pg_advisory_xact_lock(hashtext('uplinkd.sequences'));
  PERFORM setval('batches', batch + (1 << 30)) FROM batches WHERE last_value + is_called::int <= batch;
  PERFORM setval('epochs', epoch) FROM epochs WHERE last_value + is_called::int <= epoch;
  PERFORM setval('forget_requests_number_seq', request) FROM forget_requests_number_seq
    WHERE last_value + is_called::int <= request;
  RETURN true;
END $$;
