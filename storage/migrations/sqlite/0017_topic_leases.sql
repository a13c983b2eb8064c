-- Which process subscribes to which topics at a broker, by client id. released: given up, or another
-- took one of its prefixes. forget_below: deliveries with lower numbers have ended.
CREATE TABLE topic_clients (
  client_id TEXT NOT NULL PRIMARY KEY,
  process BLOB NOT NULL,
  epoch INTEGER NOT NULL,
  released INTEGER NOT NULL,
  taken_ms INTEGER NOT NULL,
  forget_below INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

-- Under which prefixes; none of a client id that was released.
CREATE TABLE topic_prefixes (
  prefix TEXT NOT NULL PRIMARY KEY,
  client_id TEXT NOT NULL
) STRICT, WITHOUT ROWID;

-- The last messages that a broker delivered to a client id and whose rows are committed, so that they
-- are known when they come again. number: counts them, over all processes. digest: of topic and
-- content; NULL where the packet id was used anew. Not called by its packet id: a row is never changed.
CREATE TABLE deliveries (
  client_id TEXT NOT NULL,
  number INTEGER NOT NULL,
  packet_id INTEGER NOT NULL,
  digest BLOB,
  PRIMARY KEY (client_id, number)
) STRICT, WITHOUT ROWID;
