-- SPDX-License-Identifier: MIT
-- The view's days are the factory's, as the centre was started with (--time-zone, --day-begin), and it knows what waits
-- for a person.  A scan that a person stopped on its way says nothing of a shoe, as on the page.
CREATE TABLE factory_day (
  one boolean PRIMARY KEY DEFAULT true CHECK (one),
  zone text NOT NULL,
  begins interval NOT NULL
);
INSERT INTO factory_day (zone, begins) VALUES ('UTC', '00:00');
DROP VIEW trends;
CREATE VIEW trends AS
  SELECT cell, model, (date_trunc('day', (time AT TIME ZONE zone) - begins) + begins) AT TIME ZONE zone AS day, count(*) AS shoes,
         count(*) FILTER (WHERE verdict = 'ok') AS ok, count(*) FILTER (WHERE verdict = 'amber') AS amber,
         count(*) FILTER (WHERE verdict = 'review') AS review, count(*) FILTER (WHERE verdict = 'refused') AS refused,
         avg(length_mm) AS mean_length_mm,
         percentile_cont(0.5) WITHIN GROUP (ORDER BY u95_mm) AS median_u95_mm,
         percentile_cont(0.5) WITHIN GROUP (ORDER BY cycle_s) AS median_cycle_s
  FROM shoes CROSS JOIN factory_day WHERE NOT (verdict = 'refused' AND reason_code = 'stopped_by_a_person')
  GROUP BY cell, model, day;
