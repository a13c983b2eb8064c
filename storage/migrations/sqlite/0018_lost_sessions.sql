-- That a broker lost a session is a row of deliveries with packet id 0: all with lower numbers have
-- ended. It was a number beside the lease.
DELETE FROM deliveries WHERE EXISTS (SELECT 1 FROM topic_clients AS c
  WHERE c.client_id = deliveries.client_id AND deliveries.number < c.forget_below);
ALTER TABLE topic_clients DROP COLUMN forget_below;
