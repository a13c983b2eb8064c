-- oldest: 1
-- Applied with search_path = uplinkd by the owner of the schema. Times of the server's clock are
-- timestamptz; those of robots (sampled_ms, expires_ms) are Unix milliseconds as they came, 0 where
-- there is none. Enumerations are the numbers of the wire. Texts of JSON hold an object by the
-- specification's names. `entry` orders rows by their writing, over all tables: the number of the
-- transaction, times 2^20, plus the place in it. Every primary key begins with the robot.

-- oldest: the schema of the oldest program that may use a store with the step.
CREATE TABLE schema_migrations (
  version integer NOT NULL PRIMARY KEY,
  oldest integer NOT NULL,
  name text NOT NULL,
  sha256 text NOT NULL,
  applied_at timestamptz NOT NULL DEFAULT now()
);

-- Drawn once a transaction, after its robots' rows are locked: so entries of one robot grow.
CREATE SEQUENCE batches;

-- Every epoch comes from here, whether a stream opens or a robot is adopted: none is ever given twice,
-- so that a robot whose row went and was made anew stands above its former holder.
CREATE SEQUENCE epochs;

-- The processes that serve this store, each with its lease: a counter that it raises every few
-- seconds, and whether it gave up its robots when it stopped. name is for people; life says where
-- the process runs and since when, for those that run beside it. renewed_at is by the database's clock, and decides
-- nothing but when the row of a process that holds no robot any more may go.
CREATE TABLE processes (
  process uuid NOT NULL PRIMARY KEY,
  name text NOT NULL,
  life text NOT NULL,
  counter bigint NOT NULL,
  released boolean NOT NULL,
  renewed_at timestamptz NOT NULL
) WITH (fillfactor = 50);

-- A civil time at which the clock of a server was vouched for, one for all that share the database: a
-- clock that stands much later is not trusted with deleting anything. No row until there was one.
CREATE TABLE clock_mark (
  id integer NOT NULL PRIMARY KEY CHECK (id = 0),
  at timestamptz NOT NULL
) WITH (fillfactor = 50);

-- owner: the process that opened the robot's last stream; held_since: the epoch of its first stream
-- since another process had the robot. A hold is one process's since one epoch: a store that went back
-- (a failover to a standby that lagged) gives epochs a second time, and its rows name older ones than
-- their holders know. holder_silent: the robot's holder fell silent since its last OpenStream, and may
-- live with a stream of it: the next adopter gives it as long as the first adopter did.
CREATE TABLE robots (
  ruri text COLLATE "C" NOT NULL PRIMARY KEY,
  fleet text COLLATE "C" NOT NULL,
  epoch bigint NOT NULL,
  held_since bigint NOT NULL,
  owner uuid NOT NULL,
  first_seen timestamptz NOT NULL,
  last_seen timestamptz NOT NULL,
  holder_silent boolean NOT NULL DEFAULT false
) WITH (fillfactor = 50);

-- cursor_seq: the last number that is committed. first_entry: quarantine rows below it belong to an
-- evicted session that had the same id. settled_seq: the highest Hello.settled_seq of the session:
-- no reader asks for quarantine rows at or below it.
--
-- A cursor's row is found in as many steps as ever while a long transaction elsewhere keeps all its
-- dead versions: it moves to a new key every 64 numbers (part), and is looked for from the greatest key
-- down, where the version that counts is. At most 64 numbers' dead versions stand before it. Within 64
-- numbers it is changed in place. A session has one row: a transaction locks the robot's row before it adds one.
CREATE TABLE sessions (
  ruri text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  cursor_seq bigint NOT NULL,
  last_used timestamptz NOT NULL,
  first_entry bigint NOT NULL,
  part bigint NOT NULL GENERATED ALWAYS AS (cursor_seq >> 6) STORED,
  settled_seq bigint NOT NULL DEFAULT 0,
  PRIMARY KEY (ruri, session, part)
) WITH (fillfactor = 50);

-- Histories: a row a report, partitioned by the day of arrival (UTC).

CREATE TABLE faults_history (
  ruri text COLLATE "C" NOT NULL,
  received_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  seq bigint NOT NULL,
  sampled_ms bigint NOT NULL,
  fault_id text COLLATE "C" NOT NULL,
  source text COLLATE "C" NOT NULL,
  severity integer NOT NULL,
  active boolean NOT NULL,
  category text NOT NULL,
  description text NOT NULL,
  suggested_action text NOT NULL,
  PRIMARY KEY (ruri, received_at, entry)
) PARTITION BY RANGE (received_at);
CREATE INDEX faults_history_by_time ON faults_history (received_at, entry);
CREATE TABLE faults_history_default PARTITION OF faults_history DEFAULT;

CREATE TABLE events (
  ruri text COLLATE "C" NOT NULL,
  received_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  seq bigint NOT NULL,
  sampled_ms bigint NOT NULL,
  kind text NOT NULL,
  detail text NOT NULL,
  PRIMARY KEY (ruri, received_at, entry)
) PARTITION BY RANGE (received_at);
CREATE INDEX events_by_time ON events (received_at, entry);
CREATE TABLE events_default PARTITION OF events DEFAULT;

-- detail: what else the sender of a message said, as the JSON text of an object; empty if that is
-- nothing.
CREATE TABLE messages (
  ruri text COLLATE "C" NOT NULL,
  received_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  seq bigint NOT NULL,
  sampled_ms bigint NOT NULL,
  level integer NOT NULL,
  message text NOT NULL,
  detail text NOT NULL DEFAULT '',
  PRIMARY KEY (ruri, received_at, entry)
) PARTITION BY RANGE (received_at);
CREATE INDEX messages_by_time ON messages (received_at, entry);
CREATE TABLE messages_default PARTITION OF messages DEFAULT;

CREATE TABLE mission_reports (
  ruri text COLLATE "C" NOT NULL,
  received_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  seq bigint NOT NULL,
  mission_id text COLLATE "C" NOT NULL,
  run_id text COLLATE "C" NOT NULL,
  status integer NOT NULL,
  report text NOT NULL,
  PRIMARY KEY (ruri, received_at, entry)
) PARTITION BY RANGE (received_at);
CREATE INDEX mission_reports_by_time ON mission_reports (received_at, entry);
CREATE INDEX mission_reports_by_run ON mission_reports (run_id, received_at, entry);
CREATE TABLE mission_reports_default PARTITION OF mission_reports DEFAULT;

-- Updates of what is no robot. ruri: what stands in a robot's place, `cyberwave:` and the prefix of the
-- topic. fleet: whose viewers may see it. sampled_ms: the sender's clock, 0 if unknown. scope: 0 an
-- environment, 1 a workflow run; id: its UUID; type: what changed, of a workflow run its status;
-- detail: the JSON text of an object in the sender's own form.
CREATE TABLE scope_updates (
  ruri text COLLATE "C" NOT NULL,
  received_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  seq bigint NOT NULL,
  sampled_ms bigint NOT NULL,
  scope integer NOT NULL,
  id text COLLATE "C" NOT NULL,
  type text NOT NULL,
  detail text NOT NULL,
  PRIMARY KEY (ruri, received_at, entry)
) PARTITION BY RANGE (received_at);
CREATE INDEX scope_updates_by_time ON scope_updates (received_at, entry);
CREATE INDEX scope_updates_by_scope ON scope_updates (scope, received_at, entry);
CREATE INDEX scope_updates_by_id ON scope_updates (id, received_at, entry);
CREATE TABLE scope_updates_default PARTITION OF scope_updates DEFAULT;

-- presence: 0 unknown, 1 online, 2 offline.
CREATE TABLE presence_changes (
  ruri text COLLATE "C" NOT NULL,
  changed_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  presence integer NOT NULL,
  PRIMARY KEY (ruri, changed_at, entry)
) PARTITION BY RANGE (changed_at);
CREATE INDEX presence_changes_by_time ON presence_changes (changed_at, entry);
CREATE TABLE presence_changes_default PARTITION OF presence_changes DEFAULT;

-- reason: RejectReason of the relay contract. payload: NULL where thinning dropped it. source: by which
-- way the message came, 0 a robot's stream, 1 Cyberwave; topic: on which it was published, empty for
-- the first.
CREATE TABLE quarantine (
  ruri text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  seq bigint NOT NULL,
  entry bigint NOT NULL,
  received_at timestamptz NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  reason integer NOT NULL,
  field text NOT NULL,
  detail text NOT NULL,
  payload_bytes bigint NOT NULL,
  payload bytea,
  source integer NOT NULL DEFAULT 0,
  topic text NOT NULL DEFAULT '',
  PRIMARY KEY (ruri, session, seq, entry, received_at)
) PARTITION BY RANGE (received_at);
CREATE INDEX quarantine_by_robot ON quarantine (ruri, received_at, entry);
CREATE INDEX quarantine_by_time ON quarantine (received_at, entry);
CREATE INDEX quarantine_by_source ON quarantine (source, received_at, entry) WHERE source <> 0;
CREATE INDEX quarantine_payloads ON quarantine (ruri, entry) WHERE payload IS NOT NULL;
CREATE TABLE quarantine_default PARTITION OF quarantine DEFAULT;

-- How many rows of a robot's quarantine went for its bound.
CREATE TABLE quarantine_dropped (
  ruri text COLLATE "C" NOT NULL,
  reason integer NOT NULL,
  count bigint NOT NULL,
  PRIMARY KEY (ruri, reason)
) WITH (fillfactor = 75);

-- Rejects that are kept for their robot alone, until a Hello confirms them: ranges of numbers that were
-- over their rate, and what retention takes out of quarantine before that. entry: as of quarantine.
CREATE TABLE kept_rejects (
  ruri text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  last bigint NOT NULL,
  first bigint NOT NULL,
  entry bigint NOT NULL,
  reason integer NOT NULL,
  field text NOT NULL,
  detail text NOT NULL,
  PRIMARY KEY (ruri, session, last)
);
-- raise_sequences asks for the greatest at each connect.
CREATE INDEX kept_rejects_by_entry ON kept_rejects (entry);

-- What is present or latest: a row a key, written at most once a transaction, with room on the page
-- for its next version.

-- raised_at and entry are those of the raise that made the fault active.
CREATE TABLE faults_active (
  ruri text COLLATE "C" NOT NULL,
  fault_id text COLLATE "C" NOT NULL,
  source text COLLATE "C" NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  raised_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  received_at timestamptz NOT NULL,
  sampled_ms bigint NOT NULL,
  severity integer NOT NULL,
  category text NOT NULL,
  description text NOT NULL,
  suggested_action text NOT NULL,
  PRIMARY KEY (ruri, fault_id, source)
) WITH (fillfactor = 75);
CREATE INDEX faults_active_by_robot ON faults_active (ruri, raised_at, entry);
CREATE INDEX faults_active_by_fleet ON faults_active (fleet, raised_at, entry);
CREATE INDEX faults_active_by_time ON faults_active (raised_at, entry);

-- first_at and entry are those of a run's first report. name: NULL until a report names the run.
-- is_open: the latest status is not terminal, and the server did not close the run; a column of its
-- own, so that a report that leaves it as it was changes no index. closed_why: 0 the server did not
-- close the run, 1 the robot had too many open, 2 the run was not reported for too long; closed_at:
-- when; the next report undoes it. last_entry: that of the latest report, so that runs stand in the
-- order of their commits whatever the clock did.
CREATE TABLE mission_runs (
  ruri text COLLATE "C" NOT NULL,
  mission_id text COLLATE "C" NOT NULL,
  run_id text COLLATE "C" NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  first_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  last_at timestamptz NOT NULL,
  name text,
  status integer NOT NULL,
  is_open boolean NOT NULL,
  updates bigint NOT NULL,
  latest text NOT NULL,
  last_entry bigint NOT NULL DEFAULT 0,
  closed_why integer NOT NULL DEFAULT 0,
  closed_at timestamptz NOT NULL DEFAULT 'epoch',
  PRIMARY KEY (ruri, mission_id, run_id)
) WITH (fillfactor = 75);
CREATE INDEX mission_runs_by_robot ON mission_runs (ruri, first_at, entry);
CREATE INDEX mission_runs_by_fleet ON mission_runs (fleet, first_at, entry);
CREATE INDEX mission_runs_by_time ON mission_runs (first_at, entry);
CREATE INDEX mission_runs_by_run ON mission_runs (run_id, first_at, entry);
CREATE INDEX mission_runs_by_mission ON mission_runs (mission_id, first_at, entry);
CREATE INDEX mission_runs_open_by_robot ON mission_runs (ruri, first_at, entry) WHERE is_open;
CREATE INDEX mission_runs_open_by_fleet ON mission_runs (fleet, first_at, entry) WHERE is_open;
CREATE INDEX mission_runs_open_by_time ON mission_runs (first_at, entry) WHERE is_open;

-- first_at and entry are those of the upsert that made the id present; received_at is that of the
-- latest. expires_ms: 0 is never. geometry: GeoJSON.
CREATE TABLE shapes (
  ruri text COLLATE "C" NOT NULL,
  id text COLLATE "C" NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  first_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  received_at timestamptz NOT NULL,
  expires_ms bigint NOT NULL,
  name text NOT NULL,
  rev bigint NOT NULL,
  hash text NOT NULL,
  area_type integer NOT NULL,
  scope integer NOT NULL,
  min_z_m double precision NOT NULL,
  max_z_m double precision NOT NULL,
  level_id integer NOT NULL,
  geometry text NOT NULL,
  PRIMARY KEY (ruri, id)
) WITH (fillfactor = 75);
CREATE INDEX shapes_by_robot ON shapes (ruri, first_at, entry);
CREATE INDEX shapes_by_fleet ON shapes (fleet, first_at, entry);
CREATE INDEX shapes_by_time ON shapes (first_at, entry);
CREATE INDEX shapes_by_expiry ON shapes (expires_ms) WHERE expires_ms <> 0;
-- For a batch that meets the robot's bound: without a look at all that is there of the robot.
CREATE INDEX shapes_by_robot_and_expiry ON shapes (ruri, expires_ms) WHERE expires_ms <> 0;
-- The items that are there, by their keys.
CREATE INDEX shapes_shared ON shapes (ruri, id) WHERE scope IN (1, 2);

-- As shapes. trajectory: NULL if there is none.
CREATE TABLE objects (
  ruri text COLLATE "C" NOT NULL,
  id text COLLATE "C" NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  first_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  received_at timestamptz NOT NULL,
  expires_ms bigint NOT NULL,
  name text NOT NULL,
  sampled_ms bigint NOT NULL,
  object_type integer NOT NULL,
  scope integer NOT NULL,
  radius_m double precision NOT NULL,
  location text NOT NULL,
  trajectory text,
  PRIMARY KEY (ruri, id)
) WITH (fillfactor = 75);
CREATE INDEX objects_by_robot ON objects (ruri, first_at, entry);
CREATE INDEX objects_by_fleet ON objects (fleet, first_at, entry);
CREATE INDEX objects_by_time ON objects (first_at, entry);
CREATE INDEX objects_by_expiry ON objects (expires_ms) WHERE expires_ms <> 0;
-- For a batch that meets the robot's bound: without a look at all that is there of the robot.
CREATE INDEX objects_by_robot_and_expiry ON objects (ruri, expires_ms) WHERE expires_ms <> 0;
-- The items that are there, by their keys.
CREATE INDEX objects_shared ON objects (ruri, id) WHERE scope IN (1, 2);

-- kind: 0 agent info, 1 settings, 2 UI capabilities.
CREATE TABLE latest (
  ruri text COLLATE "C" NOT NULL,
  kind integer NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  received_at timestamptz NOT NULL,
  body text NOT NULL,
  PRIMARY KEY (ruri, kind)
) WITH (fillfactor = 75);

-- The last row of presence_changes of each robot.
CREATE TABLE presence_latest (
  ruri text COLLATE "C" NOT NULL PRIMARY KEY,
  presence integer NOT NULL,
  changed_at timestamptz NOT NULL
) WITH (fillfactor = 75);

CREATE TABLE gaps (
  ruri text COLLATE "C" NOT NULL,
  session uuid NOT NULL,
  first bigint NOT NULL,
  last bigint NOT NULL,
  fleet text COLLATE "C" NOT NULL,
  seen_at timestamptz NOT NULL,
  entry bigint NOT NULL,
  PRIMARY KEY (ruri, session, first)
) WITH (fillfactor = 75);
CREATE INDEX gaps_by_robot ON gaps (ruri, seen_at, entry);
CREATE INDEX gaps_by_fleet ON gaps (fleet, seen_at, entry);
CREATE INDEX gaps_by_time ON gaps (seen_at, entry);

-- What a checkpoint keeps of each robot's live state: a row a robot, changed in place (no index but
-- the key's, and room on the page), each part only when it changed. The parts' bytes are messages of
-- the robot, each behind its length; rcan: the Robot State of RCAN, as JSON behind its length.
-- written_at: when its holder wrote the robot's state last, by the database's clock. settled_seq: how far
-- the robot's session was settled at the checkpoint, live messages included. held_since, store_call:
-- under which hold, and by which store call of its writer, the state was written last: a statement that
-- its server gave up, and that runs later all the same, puts nothing older over it.
CREATE TABLE live (
  ruri text COLLATE "C" NOT NULL PRIMARY KEY,
  last_sign_at timestamptz,
  clock_skew_ms bigint,
  motion bytea,
  status bytea,
  extras bytea,
  health bytea,
  usage bytea,
  consumables bytea,
  directives bytea,
  rcan bytea,
  written_at timestamptz,
  session uuid,
  settled_seq bigint,
  held_since bigint NOT NULL DEFAULT 0,
  store_call bigint NOT NULL DEFAULT 0
) WITH (fillfactor = 50);

-- Robots that an operator wants to be forgotten: the holder lets go of one and answers, and other
-- servers learn that it is gone. answer: 0 none, 1 let go, 2 has a stream, 3 records wait; epoch: that
-- of the robot when it was let go.
CREATE TABLE forget_requests (
  number bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  ruri text COLLATE "C" NOT NULL CHECK (octet_length(ruri) <= 1024),
  end_stream boolean NOT NULL,
  touched_at timestamptz NOT NULL DEFAULT now(),
  answer integer NOT NULL DEFAULT 0,
  epoch bigint NOT NULL DEFAULT 0,
  finished boolean NOT NULL DEFAULT false
);

-- Which process subscribes to which topics at a broker, by client id. released: given up, or another
-- took one of its prefixes.
CREATE TABLE topic_clients (
  client_id text COLLATE "C" NOT NULL PRIMARY KEY,
  process uuid NOT NULL,
  epoch bigint NOT NULL,
  released boolean NOT NULL,
  taken_at timestamptz NOT NULL
) WITH (fillfactor = 50);

-- Under which prefixes; none of a client id that was released.
CREATE TABLE topic_prefixes (
  prefix text COLLATE "C" NOT NULL PRIMARY KEY,
  client_id text COLLATE "C" NOT NULL
);

-- The last messages that a broker delivered to a client id and whose rows are committed, so that they
-- are known when they come again. number: counts them, over all processes. digest: of topic and
-- content; NULL where the packet id was used anew. A row is never changed, and who reads or deletes
-- knows its number: while a long transaction elsewhere keeps all the dead versions, none of them is
-- looked at. That a broker lost a session is a row with packet id 0: all with lower numbers have
-- ended.
CREATE TABLE deliveries (
  client_id text COLLATE "C" NOT NULL,
  number bigint NOT NULL,
  packet_id integer NOT NULL,
  digest uuid,
  PRIMARY KEY (client_id, number)
);

-- Which shapes and objects of scope fleet (1) or world (2) changed, for servers that hand them on to
-- other robots: upserts, deletes, what is swept, what goes with its robot, and what is narrowed to
-- another scope. Triggers note each write. A change names its item alone; what became of that is read
-- from the item's own table.
--
-- A writer is a session with the database, which draws its id with its first change. Its changes have
-- numbers from 1 without a hole, in the order of its commits: a reader that remembers a number per writer
-- misses no transaction that commits late, while one of another writer passes it. No row of these
-- tables is ever changed, since a long transaction elsewhere would keep all the dead versions: the
-- last number of a writer is looked for in its changes, from the greatest down.
CREATE TABLE change_writers (
  writer uuid NOT NULL PRIMARY KEY
);

-- kind: 1 shape, 2 object. origin: the RURI of the robot whose item it is. The column is not called
-- ruri, as those of rows that go with their robot are: a change outlives it, so that others learn that
-- its items are gone. noted_at is by the database's clock.
CREATE TABLE changes (
  writer uuid NOT NULL,
  number bigint NOT NULL,
  noted_at timestamptz NOT NULL,
  kind smallint NOT NULL,
  origin text COLLATE "C" NOT NULL,
  id text COLLATE "C" NOT NULL,
  PRIMARY KEY (writer, number)
);

-- Functions: locks and premises that must hold against a second process, and bounds on the
-- server's role.

-- What a batch needs decided before its first write, in one call: locks the robots' rows in order of
-- their keys, and draws the transaction's number. Raises UL001 where the batch cannot be written as
-- it stands, and the server then reads what is there first: a hold is not the holder's since then, a
-- session is unknown, a number is at or below its cursor, or a bound may be met.
--
-- robots, holds: the robots and the hold of each in the batch; holder: whose they are. session_*: the
-- sessions and the first number of each. bound_*: robots with raises and upserts, and how many.
-- process_*: the session of the server's own records and their first number.
CREATE FUNCTION begin_batch(
  robots text[], holds bigint[],
  session_robots text[], session_ids uuid[], session_firsts bigint[],
  bound_robots text[], bound_faults integer[], bound_shapes integer[], bound_objects integer[],
  faults_max bigint, shapes_max bigint, objects_max bigint,
  process_session uuid, process_first bigint, holder uuid)
RETURNS bigint LANGUAGE plpgsql VOLATILE AS $$
DECLARE
  found_rows bigint;
BEGIN
  SELECT count(*) INTO found_rows FROM (
    SELECT 1 FROM unnest(robots, holds) AS u (ruri, held)
      JOIN uplinkd.robots AS r ON r.ruri = u.ruri
      WHERE r.held_since = u.held AND r.owner = holder
      ORDER BY r.ruri FOR NO KEY UPDATE OF r) AS locked;
  IF found_rows <> cardinality(robots) THEN
    RAISE EXCEPTION 'this process does not hold a robot since then' USING ERRCODE = 'UL001';
  END IF;
  -- Read after the locks: a statement of its own sees what was committed until then.
  SELECT count(*) INTO found_rows
    FROM unnest(session_robots, session_ids, session_firsts) AS u (ruri, session, first)
    CROSS JOIN LATERAL (SELECT p.cursor_seq FROM uplinkd.sessions AS p
      WHERE p.ruri = u.ruri AND p.session = u.session ORDER BY p.part DESC LIMIT 1) AS s
    WHERE s.cursor_seq < u.first;
  IF found_rows <> cardinality(session_robots) THEN
    RAISE EXCEPTION 'a number is at or below its cursor' USING ERRCODE = 'UL001';
  END IF;
  IF process_session IS NOT NULL AND NOT EXISTS (
    SELECT 1 FROM (SELECT p.cursor_seq FROM uplinkd.sessions AS p
        WHERE p.ruri = 'server' AND p.session = process_session
        ORDER BY p.part DESC LIMIT 1 FOR NO KEY UPDATE) AS s
      WHERE s.cursor_seq < process_first) THEN
    RAISE EXCEPTION 'the session of the process is unknown' USING ERRCODE = 'UL001';
  END IF;
  IF cardinality(bound_robots) > 0 AND EXISTS (
    SELECT 1 FROM unnest(bound_robots, bound_faults, bound_shapes, bound_objects)
        AS u (ruri, faults, shapes, objects)
      WHERE (u.faults > 0 AND u.faults + (SELECT count(*) FROM uplinkd.faults_active AS f
               WHERE f.ruri = u.ruri) > faults_max)
         OR (u.shapes > 0 AND u.shapes + (SELECT count(*) FROM uplinkd.shapes AS f
               WHERE f.ruri = u.ruri) > shapes_max)
         OR (u.objects > 0 AND u.objects + (SELECT count(*) FROM uplinkd.objects AS f
               WHERE f.ruri = u.ruri) > objects_max)) THEN
    RAISE EXCEPTION 'a bound may be met' USING ERRCODE = 'UL001';
  END IF;
  RETURN nextval('uplinkd.batches');
END $$;

-- Of a commit, before begin_batch: raises UL001 unless each client id's lease has that epoch and process, and keeps
-- others from taking it until the transaction ends. Commits do not wait for each other.
CREATE FUNCTION hold_topics(clients text[], epochs bigint[], holder uuid)
RETURNS void LANGUAGE plpgsql VOLATILE AS $$
DECLARE
  found_rows bigint;
BEGIN
  SELECT count(*) INTO found_rows FROM (
    SELECT 1 FROM unnest(clients, epochs) AS u (client, epoch)
      JOIN uplinkd.topic_clients AS c ON c.client_id = u.client
      WHERE c.epoch = u.epoch AND c.process = holder
      ORDER BY c.client_id FOR SHARE OF c) AS locked;
  IF found_rows <> cardinality(clients) THEN
    RAISE EXCEPTION 'another process took the lease of a client id' USING ERRCODE = 'UL001';
  END IF;
END $$;

-- The histories and the column of each by which it is partitioned.
CREATE FUNCTION histories(OUT parent text, OUT arrival text)
RETURNS SETOF record LANGUAGE sql IMMUTABLE AS $$
  VALUES ('faults_history', 'received_at'), ('events', 'received_at'), ('messages', 'received_at'),
    ('mission_reports', 'received_at'), ('quarantine', 'received_at'),
    ('presence_changes', 'changed_at'), ('scope_updates', 'received_at')
$$;

-- Makes the partitions of the days from `first_day` on that are not there; returns how many. Rows of
-- such a day that lie in the default partition move into it, unless they are so many that moving them
-- would hold up the server: then the day stays there. Runs as the owner, since the server's role may
-- not create tables. Waits for a lock longer than deadlock_timeout, so that autovacuum makes way. A
-- day more than 31 days after today, or more than 10,000 before it, is refused: a wrong clock, or
-- a stolen server's role, would fill the catalogue with tables that nothing drops.
CREATE FUNCTION make_partitions(first_day date, days integer)
RETURNS integer LANGUAGE plpgsql SECURITY DEFINER
SET search_path = uplinkd, pg_temp SET lock_timeout = '1500ms' SET timezone = 'UTC' AS $$
DECLARE
  history record;
  day date;
  part text;
  held bigint;
  made integer := 0;
BEGIN
  IF days IS NULL OR days NOT BETWEEN 1 AND 31 THEN
    RAISE EXCEPTION 'days is %, outside 1 to 31', days USING ERRCODE = '22023';
  END IF;
  IF first_day + days - 1 > (now() AT TIME ZONE 'UTC')::date + 31 THEN
    RAISE EXCEPTION 'the days from % to % go further than 31 days ahead', first_day, first_day + days - 1
      USING ERRCODE = '22023';
  END IF;
  IF first_day IS NULL OR first_day < (now() AT TIME ZONE 'UTC')::date - 10000 THEN
    RAISE EXCEPTION 'the days from % on begin more than 10000 days ago', first_day USING ERRCODE = '22023';
  END IF;
  -- Two servers that do this at once would trip over each other's tables.
  PERFORM pg_advisory_xact_lock(hashtext('uplinkd.partitions'));
  FOR history IN SELECT * FROM histories() LOOP
    FOR i IN 0 .. days - 1 LOOP
      day := first_day + i;
      part := format('%s_%s', history.parent, to_char(day, 'YYYYMMDD'));
      CONTINUE WHEN to_regclass(format('uplinkd.%I', part)) IS NOT NULL;
      EXECUTE format('SELECT count(*) FROM (SELECT FROM %I WHERE %I >= %L AND %I < %L LIMIT 10001) AS h',
                     history.parent || '_default', history.arrival, day, history.arrival, day + 1)
        INTO held;
      CONTINUE WHEN held > 10000;
      EXECUTE format('CREATE TABLE %I (LIKE %I INCLUDING ALL)', part, history.parent);
      IF held > 0 THEN
        EXECUTE format('LOCK TABLE %I IN ACCESS EXCLUSIVE MODE', history.parent || '_default');
        EXECUTE format('WITH moved AS (DELETE FROM %I WHERE %I >= %L AND %I < %L RETURNING *)'
                       ' INSERT INTO %I SELECT * FROM moved',
                       history.parent || '_default', history.arrival, day, history.arrival, day + 1,
                       part);
      END IF;
      EXECUTE format('ALTER TABLE %I ATTACH PARTITION %I FOR VALUES FROM (%L) TO (%L)',
                     history.parent, part, day, day + 1);
      made := made + 1;
    END LOOP;
  END LOOP;
  RETURN made;
END $$;

-- Drops the partitions of one history that end at or before `before`, the oldest first, at most ten a
-- call; returns how many. Runs as the owner. Yesterday and what comes after it is never dropped: no
-- history is kept for less than a day. Clocks may differ by ten minutes: shortly before midnight, a
-- server's day is the next one already. A day of quarantine is dropped only if it is empty:
-- take_quarantine empties it. What commits a row of that day meanwhile is waited for, and then the day
-- stays.
CREATE FUNCTION drop_partitions(history_name text, before date)
RETURNS integer LANGUAGE plpgsql SECURITY DEFINER
SET search_path = uplinkd, pg_temp SET lock_timeout = '1500ms' SET timezone = 'UTC' AS $$
DECLARE
  part record;
  filled bigint;
  dropped integer := 0;
BEGIN
  IF NOT EXISTS (SELECT FROM histories() AS h WHERE h.parent = history_name) THEN
    RAISE EXCEPTION '% is no history', history_name USING ERRCODE = '22023';
  END IF;
  IF before > ((now() + interval '10 minutes') AT TIME ZONE 'UTC')::date - 1 THEN
    RAISE EXCEPTION 'days before % are not all older than a day', before USING ERRCODE = '22023';
  END IF;
  PERFORM pg_advisory_xact_lock(hashtext('uplinkd.partitions'));
  FOR part IN
    SELECT c.relname FROM pg_inherits AS i JOIN pg_class AS c ON c.oid = i.inhrelid
      WHERE i.inhparent = format('uplinkd.%I', history_name)::regclass
        AND c.relname ~ ('^' || history_name || '_[0-9]{8}$')
        AND to_date(right(c.relname, 8), 'YYYYMMDD') < before
      ORDER BY c.relname LIMIT 10
  LOOP
    IF history_name = 'quarantine' THEN
      -- Before the lock, so that a day that has rows holds up no commit. By the index in which
      -- take_quarantine looked.
      EXECUTE format('SELECT entry FROM %I ORDER BY received_at, entry LIMIT 1', part.relname) INTO filled;
      EXIT WHEN filled IS NOT NULL;
      -- Writers lock the table before its day, as DROP does.
      LOCK TABLE ONLY quarantine IN ACCESS EXCLUSIVE MODE;
      EXECUTE format('SELECT entry FROM %I ORDER BY received_at, entry LIMIT 1', part.relname) INTO filled;
      EXIT WHEN filled IS NOT NULL;
    END IF;
    EXECUTE format('DROP TABLE %I', part.relname);
    dropped := dropped + 1;
  END LOOP;
  RETURN dropped;
END $$;

-- A day of quarantine is emptied in slices, between which others commit, before it is dropped.
--
-- Deletes the oldest rows of the oldest day of quarantine that ends at or before `before`, at most
-- `rows_max`, and keeps the Rejects among them that a Hello may still ask for (at most 10,000 per session)
-- in kept_rejects, in the same transaction. Looks at no row that arrived before `since`: those that earlier
-- calls deleted are passed over. The day is null where there is none. first_at: the arrival of the first row
-- that went. Runs as the owner. The days are those of drop_partitions.
CREATE FUNCTION take_quarantine(before date, since timestamptz, rows_max integer,
  OUT day date, OUT first_at timestamptz, OUT taken integer, OUT kept integer)
LANGUAGE plpgsql SECURITY DEFINER
SET search_path = uplinkd, pg_temp SET lock_timeout = '1500ms' SET timezone = 'UTC' AS $$
DECLARE
  part name;
BEGIN
  IF before > ((now() + interval '10 minutes') AT TIME ZONE 'UTC')::date - 1 THEN
    RAISE EXCEPTION 'days before % are not all older than a day', before USING ERRCODE = '22023';
  END IF;
  IF rows_max IS NULL OR rows_max NOT BETWEEN 1 AND 10000 THEN
    RAISE EXCEPTION 'rows_max is %, outside 1 to 10000', rows_max USING ERRCODE = '22023';
  END IF;
  PERFORM pg_advisory_xact_lock(hashtext('uplinkd.partitions'));
  SELECT c.relname INTO part FROM pg_inherits AS i JOIN pg_class AS c ON c.oid = i.inhrelid
    WHERE i.inhparent = 'uplinkd.quarantine'::regclass AND c.relname ~ '^quarantine_[0-9]{8}$'
      AND to_date(right(c.relname, 8), 'YYYYMMDD') < before
    ORDER BY c.relname LIMIT 1;
  IF part IS NULL THEN
    RETURN;
  END IF;
  day := to_date(right(part, 8), 'YYYYMMDD');
  EXECUTE format(
    'WITH went AS (DELETE FROM %1$I WHERE ctid = ANY (ARRAY('
    ' SELECT ctid FROM %1$I WHERE received_at >= $1 ORDER BY received_at, entry LIMIT $2))'
    ' RETURNING ruri, session, seq, entry, received_at, source, reason, field, detail),'
    ' kept AS (INSERT INTO kept_rejects (ruri, session, last, first, entry, reason, field, detail)'
    ' SELECT q.ruri, q.session, q.seq, q.seq, q.entry, q.reason, q.field, q.detail FROM went AS q'
    ' CROSS JOIN LATERAL (SELECT l.first_entry, l.settled_seq FROM sessions AS l'
    ' WHERE l.ruri = q.ruri AND l.session = q.session ORDER BY l.part DESC LIMIT 1) AS s'
    ' WHERE q.source = 0 AND q.entry >= s.first_entry AND q.seq > s.settled_seq'
    ' ON CONFLICT DO NOTHING RETURNING 1)'
    ' SELECT (SELECT min(received_at) FROM went), (SELECT count(*) FROM went),'
    ' (SELECT count(*) FROM kept)', part)
    INTO first_at, taken, kept USING since, rows_max;
END $$;

-- Raises every sequence above what rows name of it, where it is left behind: logical replication copies
-- rows and no sequences. An entry below its session's first hides a Reject, an epoch that was given before
-- has a holder, and a number of a request that is there already is refused. Returns whether anything was
-- behind. Runs as the owner, since the server's role may draw from a sequence and not set it. Called at each
-- connect, so of a table with an index of times it looks at the newest row alone; where these show that
-- `batches` is behind, it is raised by 2^30 more, for rows that are older by their times.
CREATE FUNCTION raise_sequences()
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
      ('objects', 'first_at', 'entry'), ('gaps', 'seen_at', 'entry')
  LOOP
    EXECUTE format('SELECT %I FROM %I ORDER BY %I DESC, entry DESC LIMIT 1',
                   source.number, source.parent, source.arrival) INTO seen;
    batch := greatest(batch, seen);
  END LOOP;
  batch := batch >> 20;
  SELECT greatest((SELECT max(r.epoch) FROM robots AS r), (SELECT max(l.held_since) FROM live AS l),
                  (SELECT max(c.epoch) FROM topic_clients AS c), 0) INTO epoch;
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

-- Each role that may run them is granted so by name.
REVOKE EXECUTE ON ALL FUNCTIONS IN SCHEMA uplinkd FROM PUBLIC;

-- Takes the lease of all these prefixes for the client id and returns its epoch; NULL, and nothing is
-- taken, if another process holds the client id or one of the prefixes. over_*: processes that are
-- over, each with the counter that its lease had when that was found: one that has another since is not. Who
-- holds the client id already keeps its epoch. One taker at a time; a commit under a lease that ends
-- here is waited for.
CREATE FUNCTION take_topics(
  client text, wanted text[], taker uuid, over_processes uuid[], over_counters bigint[],
  taken timestamptz, deliveries_max bigint, clients_max bigint)
RETURNS bigint LANGUAGE plpgsql VOLATILE AS $$
DECLARE
  mine bigint;
  newest bigint;
  gone text[];
BEGIN
  PERFORM pg_advisory_xact_lock(hashtext('uplinkd.topics'));
  PERFORM FROM uplinkd.topic_clients AS c
    WHERE NOT c.released AND c.process <> taker
      AND (c.client_id = client OR EXISTS (SELECT 1 FROM uplinkd.topic_prefixes AS p
        WHERE p.client_id = c.client_id AND p.prefix = ANY (wanted)))
      AND NOT EXISTS (SELECT 1 FROM unnest(over_processes, over_counters) AS o (process, counter)
        WHERE o.process = c.process AND NOT EXISTS (SELECT 1 FROM uplinkd.processes AS p
          WHERE p.process = o.process AND p.counter <> o.counter));
  IF FOUND THEN
    RETURN NULL;
  END IF;
  -- The leases that change, in the order in which commits hold theirs, and before their prefixes, as
  -- a release does.
  PERFORM FROM uplinkd.topic_clients AS c
    WHERE (c.client_id = client AND (c.released OR c.process <> taker))
      OR (c.client_id <> client AND EXISTS (SELECT 1 FROM uplinkd.topic_prefixes AS p
        WHERE p.client_id = c.client_id AND p.prefix = ANY (wanted)))
    ORDER BY c.client_id FOR UPDATE;
  UPDATE uplinkd.topic_clients AS c SET released = true, epoch = nextval('uplinkd.epochs')
    WHERE c.client_id <> client AND EXISTS (SELECT 1 FROM uplinkd.topic_prefixes AS p
      WHERE p.client_id = c.client_id AND p.prefix = ANY (wanted));
  DELETE FROM uplinkd.topic_prefixes AS p USING uplinkd.topic_clients AS c
    WHERE c.client_id = p.client_id AND (c.released OR c.client_id = client);
  SELECT c.epoch INTO mine FROM uplinkd.topic_clients AS c
    WHERE c.client_id = client AND c.process = taker AND NOT c.released;
  IF mine IS NULL THEN
    mine := nextval('uplinkd.epochs');
    INSERT INTO uplinkd.topic_clients AS c (client_id, process, epoch, released, taken_at)
      VALUES (client, taker, mine, false, taken)
      ON CONFLICT (client_id) DO UPDATE SET process = excluded.process, epoch = excluded.epoch,
        released = false, taken_at = excluded.taken_at;
    -- No commit under an older epoch is on its way any more. What is known is numbered anew, without
    -- a hole and above all that were given; the rest goes.
    SELECT d.number INTO newest FROM uplinkd.deliveries AS d WHERE d.client_id = client
      ORDER BY d.number DESC LIMIT 1;
    INSERT INTO uplinkd.deliveries (client_id, number, packet_id, digest)
      SELECT client, newest + row_number() OVER (ORDER BY k.number), k.packet_id, k.digest
        FROM (SELECT DISTINCT ON (d.packet_id) d.number, d.packet_id, d.digest
          FROM uplinkd.deliveries AS d WHERE d.client_id = client
            AND d.number > newest - deliveries_max
            AND d.number > coalesce((SELECT max(l.number) FROM uplinkd.deliveries AS l
              WHERE l.client_id = client AND l.number > newest - deliveries_max
                AND l.packet_id = 0), 0)
          ORDER BY d.packet_id, d.number DESC) AS k
        WHERE k.digest IS NOT NULL;
    DELETE FROM uplinkd.deliveries AS d WHERE d.client_id = client AND d.number <= newest;
  END IF;
  INSERT INTO uplinkd.topic_prefixes (prefix, client_id) SELECT u.prefix, client
    FROM unnest(wanted) AS u (prefix);
  WITH old AS (
    DELETE FROM uplinkd.topic_clients AS c WHERE c.client_id IN (
      SELECT o.client_id FROM uplinkd.topic_clients AS o WHERE o.released
      ORDER BY o.taken_at, o.client_id
      LIMIT greatest(0, (SELECT count(*) FROM uplinkd.topic_clients) - clients_max))
    RETURNING c.client_id)
  SELECT array_agg(o.client_id) INTO gone FROM old AS o;
  -- A statement of its own, which sees what a commit wrote that the one before waited for.
  DELETE FROM uplinkd.deliveries AS d WHERE d.client_id = ANY (gone);
  RETURN mine;
END $$;

-- Of a trigger on shapes or objects; its argument is the kind. `removed` are the rows as they were,
-- `added` as they are. A statement that touches no such scope costs the look alone.
--
-- The row of the writer is locked: a sweep may take it away with its changes, and then, or where all
-- of its changes went, the session goes on as a new writer. An id and its numbers never come again.
-- A rollback takes the numbers back, and a drawn id with them.
CREATE FUNCTION note_changes() RETURNS trigger LANGUAGE plpgsql AS $$
DECLARE
  origins text[];
  ids text[];
  mine uuid;
  last_number bigint;
BEGIN
  IF TG_OP = 'INSERT' THEN
    SELECT array_agg(a.ruri), array_agg(a.id) INTO origins, ids
      FROM added AS a WHERE a.scope IN (1, 2);
  ELSIF TG_OP = 'DELETE' THEN
    SELECT array_agg(r.ruri), array_agg(r.id) INTO origins, ids
      FROM removed AS r WHERE r.scope IN (1, 2);
  ELSE
    SELECT array_agg(e.ruri), array_agg(e.id) INTO origins, ids
      FROM (SELECT r.ruri, r.id FROM removed AS r WHERE r.scope IN (1, 2)
            UNION SELECT a.ruri, a.id FROM added AS a WHERE a.scope IN (1, 2)) AS e;
  END IF;
  IF ids IS NULL THEN
    RETURN NULL;
  END IF;
  mine := nullif(current_setting('uplinkd.writer', true), '');
  IF mine IS NOT NULL THEN
    PERFORM FROM uplinkd.change_writers AS w WHERE w.writer = mine FOR NO KEY UPDATE;
    IF FOUND THEN
      SELECT c.number INTO last_number FROM uplinkd.changes AS c
        WHERE c.writer = mine ORDER BY c.number DESC LIMIT 1;
    END IF;
  END IF;
  IF last_number IS NULL THEN
    last_number := 0;
    mine := gen_random_uuid();
    PERFORM set_config('uplinkd.writer', mine::text, false);
    INSERT INTO uplinkd.change_writers (writer) VALUES (mine);
  END IF;
  INSERT INTO uplinkd.changes (writer, number, noted_at, kind, origin, id)
    SELECT mine, last_number + u.place, clock_timestamp(), TG_ARGV[0]::smallint, u.origin, u.id
    FROM unnest(origins, ids) WITH ORDINALITY AS u (origin, id, place);
  RETURN NULL;
END $$;

CREATE TRIGGER shapes_added AFTER INSERT ON shapes REFERENCING NEW TABLE AS added
  FOR EACH STATEMENT EXECUTE FUNCTION note_changes('1');
CREATE TRIGGER shapes_changed AFTER UPDATE ON shapes
  REFERENCING OLD TABLE AS removed NEW TABLE AS added
  FOR EACH STATEMENT EXECUTE FUNCTION note_changes('1');
CREATE TRIGGER shapes_removed AFTER DELETE ON shapes REFERENCING OLD TABLE AS removed
  FOR EACH STATEMENT EXECUTE FUNCTION note_changes('1');
CREATE TRIGGER objects_added AFTER INSERT ON objects REFERENCING NEW TABLE AS added
  FOR EACH STATEMENT EXECUTE FUNCTION note_changes('2');
CREATE TRIGGER objects_changed AFTER UPDATE ON objects
  REFERENCING OLD TABLE AS removed NEW TABLE AS added
  FOR EACH STATEMENT EXECUTE FUNCTION note_changes('2');
CREATE TRIGGER objects_removed AFTER DELETE ON objects REFERENCING OLD TABLE AS removed
  FOR EACH STATEMENT EXECUTE FUNCTION note_changes('2');

-- Deletes the oldest changes of each writer but `kept`, and writers that changed nothing for so many
-- hours, with all of theirs: at most `rows_max` rows per call. Returns how many went. One session at a
-- time does it; another finds nothing to do.
CREATE FUNCTION sweep_changes(kept bigint, idle_hours integer, rows_max bigint)
RETURNS bigint LANGUAGE plpgsql AS $$
DECLARE
  one record;
  newest bigint;
  deleted bigint;
  gone bigint := 0;
BEGIN
  IF NOT pg_try_advisory_xact_lock(hashtext('uplinkd.changes')) THEN
    RETURN 0;
  END IF;
  FOR one IN
    SELECT w.writer, l.number AS last, f.number AS first,
        coalesce(l.noted_at < clock_timestamp() - make_interval(hours => idle_hours), true) AS is_idle
      FROM uplinkd.change_writers AS w
      LEFT JOIN LATERAL (SELECT c.number, c.noted_at FROM uplinkd.changes AS c
        WHERE c.writer = w.writer ORDER BY c.number DESC LIMIT 1) AS l ON true
      LEFT JOIN LATERAL (SELECT c.number FROM uplinkd.changes AS c
        WHERE c.writer = w.writer ORDER BY c.number LIMIT 1) AS f ON true
  LOOP
    EXIT WHEN gone >= rows_max;
    IF one.is_idle THEN
      -- From here on it notes nothing: its session waits, and finds what is left, or begins anew.
      PERFORM FROM uplinkd.change_writers AS w WHERE w.writer = one.writer FOR UPDATE SKIP LOCKED;
      CONTINUE WHEN NOT FOUND;
      SELECT max(c.number) INTO newest FROM uplinkd.changes AS c WHERE c.writer = one.writer;
      CONTINUE WHEN newest IS DISTINCT FROM one.last;
      DELETE FROM uplinkd.changes AS c
        WHERE c.writer = one.writer AND c.number < one.first + rows_max - gone;
      GET DIAGNOSTICS deleted = ROW_COUNT;
      DELETE FROM uplinkd.change_writers AS w WHERE w.writer = one.writer
        AND NOT EXISTS (SELECT 1 FROM uplinkd.changes AS c WHERE c.writer = one.writer);
    ELSE
      DELETE FROM uplinkd.changes AS c WHERE c.writer = one.writer
        AND c.number <= one.last - kept AND c.number < one.first + rows_max - gone;
      GET DIAGNOSTICS deleted = ROW_COUNT;
    END IF;
    gone := gone + deleted;
  END LOOP;
  RETURN gone;
END $$;

-- A robot that a certificate moves to another fleet takes its shapes and objects with it: they belong
-- to the fleet of their robot, for those who list them and for the robots that they are handed on to.
CREATE FUNCTION move_items() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  UPDATE uplinkd.shapes AS s SET fleet = NEW.fleet
    WHERE s.ruri = NEW.ruri AND s.fleet <> NEW.fleet;
  UPDATE uplinkd.objects AS o SET fleet = NEW.fleet
    WHERE o.ruri = NEW.ruri AND o.fleet <> NEW.fleet;
  RETURN NULL;
END $$;
CREATE TRIGGER robots_moved AFTER UPDATE OF fleet ON robots
  FOR EACH ROW WHEN (OLD.fleet <> NEW.fleet) EXECUTE FUNCTION move_items();

-- TRUNCATE passes over the triggers of rows: what went is not known. A writer whose first change has
-- number 2 has a hole, and a reader that finds a hole reads all items anew.
CREATE FUNCTION note_truncation() RETURNS trigger LANGUAGE plpgsql AS $$
DECLARE
  mine uuid := gen_random_uuid();
BEGIN
  INSERT INTO uplinkd.change_writers (writer) VALUES (mine);
  INSERT INTO uplinkd.changes (writer, number, noted_at, kind, origin, id)
    VALUES (mine, 2, clock_timestamp(), TG_ARGV[0]::smallint, '', '');
  RETURN NULL;
END $$;
CREATE TRIGGER shapes_truncated AFTER TRUNCATE ON shapes
  FOR EACH STATEMENT EXECUTE FUNCTION note_truncation('1');
CREATE TRIGGER objects_truncated AFTER TRUNCATE ON objects
  FOR EACH STATEMENT EXECUTE FUNCTION note_truncation('2');
