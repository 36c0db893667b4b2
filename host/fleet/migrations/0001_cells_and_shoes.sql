-- SPDX-License-Identifier: MIT
-- A book is one memory file of a cell; its shoes come in the order of their seq.
CREATE TABLE cells (
  cell text PRIMARY KEY,
  online boolean NOT NULL,
  heard timestamptz NOT NULL,
  version text NOT NULL,
  book text NOT NULL,
  waiting bigint NOT NULL
);
CREATE TABLE books (
  cell text NOT NULL,
  book text NOT NULL,
  seq bigint NOT NULL,
  PRIMARY KEY (cell, book)
);
CREATE TABLE shoes (
  id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  cell text NOT NULL,
  book text NOT NULL,
  scan text NOT NULL,
  first_seq bigint NOT NULL,
  last_seq bigint NOT NULL,
  time timestamptz NOT NULL,
  model text NOT NULL,
  verdict text NOT NULL,
  reason_code text NOT NULL,
  reason text NOT NULL,
  length_mm double precision,
  confidence double precision,
  u95_mm double precision,
  cycle_s double precision,
  process text NOT NULL,
  decision text NOT NULL,
  sent boolean NOT NULL,
  followed boolean NOT NULL,
  places real[],
  FOREIGN KEY (cell, book) REFERENCES books (cell, book),
  UNIQUE (cell, book, scan)
);
CREATE INDEX shoes_time ON shoes (time);
CREATE INDEX shoes_model ON shoes (model, cell, id);
CREATE VIEW trends AS
  SELECT cell, model, date_trunc('day', time, 'UTC') AS day, count(*) AS shoes,
         count(*) FILTER (WHERE verdict = 'ok') AS ok, count(*) FILTER (WHERE verdict = 'amber') AS amber,
         count(*) FILTER (WHERE verdict = 'refused') AS refused,
         avg(length_mm) AS mean_length_mm,
         percentile_cont(0.5) WITHIN GROUP (ORDER BY u95_mm) AS median_u95_mm,
         percentile_cont(0.5) WITHIN GROUP (ORDER BY cycle_s) AS median_cycle_s
  FROM shoes GROUP BY cell, model, day;
