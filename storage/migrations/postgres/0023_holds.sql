-- A hold is one process's since one epoch: a store that went back (a failover to a standby that lagged)
-- gives epochs a second time, and its rows name older ones than their holders know.

-- As in 0007, but that a hold counts only with its owner, and since exactly then.
DROP FUNCTION begin_batch(text[], bigint[], text[], uuid[], bigint[], text[], integer[], integer[],
  integer[], bigint, bigint, bigint, uuid, bigint);
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
REVOKE EXECUTE ON FUNCTION begin_batch FROM PUBLIC;

-- As in 0020, but that a lease counts only with its process.
DROP FUNCTION hold_topics(text[], bigint[]);
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
REVOKE EXECUTE ON FUNCTION hold_topics FROM PUBLIC;

-- As in 0021, but that a process whose counter is another one than when it was judged is not over, though
-- it is a lower one.
CREATE OR REPLACE FUNCTION take_topics(
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
  -- whoever gives one up does.
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

-- Raises every sequence above what rows name of it, where it is left behind: logical replication copies
-- rows and no sequences. An entry below its session's first hides a Reject, an epoch that was given before
-- is somebody's, and a number of a request that is there already is refused. Returns whether anything was
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
REVOKE EXECUTE ON FUNCTION raise_sequences FROM PUBLIC;
