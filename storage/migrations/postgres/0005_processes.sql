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

-- When its holder wrote the robot's state last, by the database's clock.
ALTER TABLE live ADD COLUMN written_at timestamptz;
