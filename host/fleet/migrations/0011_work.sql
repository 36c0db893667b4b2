-- SPDX-License-Identifier: MIT
-- What a look after the work told, and which scan of the same shoe it works on with; cells of before say none of it.
ALTER TABLE shoes ADD COLUMN follows text NOT NULL DEFAULT '';
ALTER TABLE shoes ADD COLUMN work text NOT NULL DEFAULT '';
ALTER TABLE shoes ADD COLUMN work_reworked boolean NOT NULL DEFAULT false;
ALTER TABLE shoes ADD COLUMN work_missing_mm double precision;
ALTER TABLE shoes ADD COLUMN work_narrow integer NOT NULL DEFAULT 0;
ALTER TABLE shoes ADD COLUMN work_wide integer NOT NULL DEFAULT 0;
ALTER TABLE shoes ADD COLUMN work_beside integer NOT NULL DEFAULT 0;
ALTER TABLE shoes ADD COLUMN work_doubled integer NOT NULL DEFAULT 0;
-- A shoe counts once.
DROP VIEW trends;
CREATE VIEW trends AS
  SELECT cell, model, (date_trunc('day', (time AT TIME ZONE zone) - begins) + begins) AT TIME ZONE zone AS day, count(*) AS shoes,
         count(*) FILTER (WHERE verdict = 'ok') AS ok, count(*) FILTER (WHERE verdict = 'amber') AS amber,
         count(*) FILTER (WHERE verdict = 'review') AS review, count(*) FILTER (WHERE verdict = 'refused') AS refused,
         avg(length_mm) AS mean_length_mm,
         percentile_cont(0.5) WITHIN GROUP (ORDER BY u95_mm) AS median_u95_mm,
         percentile_cont(0.5) WITHIN GROUP (ORDER BY cycle_s) AS median_cycle_s
  FROM shoes CROSS JOIN factory_day WHERE NOT (verdict = 'refused' AND reason_code = 'stopped_by_a_person') AND follows = ''
  GROUP BY cell, model, day;
