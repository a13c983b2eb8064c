-- oldest: 1
-- A step that only adds: servers of the schema before it go on.
ALTER TABLE robots ADD COLUMN made_up text NOT NULL DEFAULT '';
CREATE TABLE made_up (
  number bigint NOT NULL PRIMARY KEY
);
