-- That a broker lost a session is a row of deliveries with packet id 0: all with lower numbers have
-- ended. It was a number beside the lease, in a row that each commit under it locks: two that changed
-- it waited for each other.
DELETE FROM deliveries AS d USING topic_clients AS c
  WHERE d.client_id = c.client_id AND d.number < c.forget_below;
DELETE FROM deliveries AS d
  WHERE NOT EXISTS (SELECT FROM topic_clients AS c WHERE c.client_id = d.client_id);
ALTER TABLE topic_clients DROP COLUMN forget_below;

-- Takes the lease of all these prefixes for the client id and returns its epoch; NULL, and nothing is
-- taken, if another process holds the client id or one of the prefixes. over_*: processes that are
-- over, each with the counter that its lease had when that was found: one that grew since is not. Who
-- holds the client id already keeps its epoch. One taker at a time; a commit under a lease that ends
-- here is waited for.
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
          WHERE p.process = o.process AND p.counter > o.counter));
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
