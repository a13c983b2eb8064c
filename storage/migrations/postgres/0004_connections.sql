-- oldest: 1
-- Connections of robots, and why a robot went offline. Applied as 0001.

-- A connection of a robot: a stream, a twin's client at a broker, a drone's calls; at most 64 of a robot.
-- source: as in quarantine; process: the server that served it, and server where robots reached that one.
-- address: from where the robot connected. held_back_ms: for how long it was held back in all.
-- ended_*: NULL while it is open. ended_why: 0 orderly, 1 broken, 2 silent, 3 replaced, 4 drained,
-- 5 not read, 6 protocol error, 7 refused, 8 certificate expired, 9 the server ended.
CREATE TABLE connections (
  ruri text COLLATE "C" NOT NULL,
  id uuid NOT NULL,
  began_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  source integer NOT NULL,
  process uuid NOT NULL,
  server text NOT NULL,
  address text NOT NULL,
  gateway text NOT NULL,
  agent_version text NOT NULL,
  certificate_serial text NOT NULL,
  certificate_sha256 text NOT NULL,
  certificate_key_sha256 text NOT NULL,
  certificate_not_after timestamptz,
  messages bigint NOT NULL,
  bytes bigint NOT NULL,
  takeovers bigint NOT NULL,
  held_back_ms bigint NOT NULL,
  held_back_why text NOT NULL,
  is_open boolean NOT NULL,
  ended_at timestamptz,
  ended_why integer,
  ended_code text,
  ended_detail text,
  PRIMARY KEY (ruri, id)
) WITH (fillfactor = 75);
CREATE INDEX connections_by_robot ON connections (ruri, began_at, entry);
CREATE INDEX connections_by_fleet ON connections (fleet, began_at, entry);
CREATE INDEX connections_by_time ON connections (began_at, entry);
CREATE INDEX connections_open_by_robot ON connections (ruri, began_at, entry) WHERE is_open;
CREATE INDEX connections_open_by_fleet ON connections (fleet, began_at, entry) WHERE is_open;
CREATE INDEX connections_open_by_time ON connections (began_at, entry) WHERE is_open;
CREATE INDEX connections_by_why ON connections (ended_why, began_at, entry, fleet);
CREATE INDEX connections_by_source ON connections (source, began_at, entry, fleet);
CREATE INDEX connections_open_by_process ON connections (process) WHERE is_open;

-- Why the last connection of a robot that goes offline ended, as ended_why; NULL where that is unknown.
ALTER TABLE presence_changes ADD COLUMN why integer;

-- Until when the robot is parked, as it said with its Goodbye; NULL if it is not.
ALTER TABLE presence_latest ADD COLUMN parked_until timestamptz;

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
      ('operator_requests', 'opened_at', 'entry'), ('connections', 'began_at', 'entry')
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
