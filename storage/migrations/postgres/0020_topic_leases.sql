-- Which process subscribes to which topics at a broker, by client id. released: given up, or another
-- took one of its prefixes. forget_below: deliveries with lower numbers have ended.
CREATE TABLE topic_clients (
  client_id text COLLATE "C" NOT NULL PRIMARY KEY,
  process uuid NOT NULL,
  epoch bigint NOT NULL,
  released boolean NOT NULL,
  taken_at timestamptz NOT NULL,
  forget_below bigint NOT NULL
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
-- looked at.
CREATE TABLE deliveries (
  client_id text COLLATE "C" NOT NULL,
  number bigint NOT NULL,
  packet_id integer NOT NULL,
  digest uuid,
  PRIMARY KEY (client_id, number)
);

-- Of a commit, before begin_batch: raises UL001 unless each client id's lease has that epoch, and keeps
-- others from taking it until the transaction ends. Commits do not wait for each other.
CREATE FUNCTION hold_topics(clients text[], epochs bigint[])
RETURNS void LANGUAGE plpgsql VOLATILE AS $$
DECLARE
  found_rows bigint;
BEGIN
  SELECT count(*) INTO found_rows FROM (
    SELECT 1 FROM unnest(clients, epochs) AS u (client, epoch)
      JOIN uplinkd.topic_clients AS c ON c.client_id = u.client
      WHERE c.epoch = u.epoch
      ORDER BY c.client_id FOR SHARE OF c) AS locked;
  IF found_rows <> cardinality(clients) THEN
    RAISE EXCEPTION 'another process took the lease of a client id' USING ERRCODE = 'UL001';
  END IF;
END $$;

-- Takes the lease of all these prefixes for the client id and returns its epoch; NULL, and nothing is
-- taken, if another process holds the client id or one of the prefixes. over_*: processes that are
-- over, each with the counter that its lease had when that was found: one that grew since is not. Who
-- holds the client id already keeps its epoch. One taker at a time; a commit under a lease that ends
-- here is waited for.
CREATE FUNCTION take_topics(
  client text, wanted text[], taker uuid, over_processes uuid[], over_counters bigint[],
  taken timestamptz, deliveries_max bigint, clients_max bigint)
RETURNS bigint LANGUAGE plpgsql VOLATILE AS $$
DECLARE
  mine bigint;
BEGIN
  PERFORM pg_advisory_xact_lock(hashtext('uplinkd.topics'));
  PERFORM FROM uplinkd.topic_clients AS c
    WHERE NOT c.released AND c.process <> taker
      AND (c.client_id = client OR EXISTS (SELECT 1 FROM uplinkd.topic_prefixes AS p
        WHERE p.client_id = c.client_id AND p.prefix = ANY (wanted)))
      AND NOT EXISTS (SELECT 1 FROM unnest(over_processes, over_counters) AS o (process, counter)
        WHERE o.process = c.process AND NOT EXISTS (SELECT 1 FROM uplinkd.processes AS p
          WHERE p.process = o.process AND p.counter > o.counter));
  IF FOUND THEN
    RETURN NULL;
  END IF;
  UPDATE uplinkd.topic_clients AS c SET released = true, epoch = nextval('uplinkd.epochs')
    WHERE c.client_id <> client AND EXISTS (SELECT 1 FROM uplinkd.topic_prefixes AS p
      WHERE p.client_id = c.client_id AND p.prefix = ANY (wanted));
  DELETE FROM uplinkd.topic_prefixes AS p USING uplinkd.topic_clients AS c
    WHERE c.client_id = p.client_id AND (c.released OR c.client_id = client);
  SELECT c.epoch INTO mine FROM uplinkd.topic_clients AS c
    WHERE c.client_id = client AND c.process = taker AND NOT c.released;
  IF mine IS NULL THEN
    mine := nextval('uplinkd.epochs');
    INSERT INTO uplinkd.topic_clients AS c (client_id, process, epoch, released, taken_at, forget_below)
      VALUES (client, taker, mine, false, taken, 0)
      ON CONFLICT (client_id) DO UPDATE SET process = excluded.process, epoch = excluded.epoch,
        released = false, taken_at = excluded.taken_at;
  END IF;
  INSERT INTO uplinkd.topic_prefixes (prefix, client_id) SELECT u.prefix, client
    FROM unnest(wanted) AS u (prefix);
  DELETE FROM uplinkd.deliveries AS d WHERE d.client_id = client
    AND d.number <= (SELECT l.number FROM uplinkd.deliveries AS l WHERE l.client_id = client
      ORDER BY l.number DESC LIMIT 1) - deliveries_max;
  WITH gone AS (
    DELETE FROM uplinkd.topic_clients AS c WHERE c.client_id IN (
      SELECT o.client_id FROM uplinkd.topic_clients AS o WHERE o.released
      ORDER BY o.taken_at, o.client_id
      LIMIT greatest(0, (SELECT count(*) FROM uplinkd.topic_clients) - clients_max))
    RETURNING c.client_id)
  DELETE FROM uplinkd.deliveries AS d USING gone AS g WHERE d.client_id = g.client_id;
  RETURN mine;
END $$;
