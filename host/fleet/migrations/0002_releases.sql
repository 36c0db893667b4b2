-- SPDX-License-Identifier: MIT
-- A release is models and processes as one signed file; it stands here in parts, as cells ask for them.
ALTER TABLE shoes ADD COLUMN release text NOT NULL DEFAULT '';
CREATE TABLE releases (
  number integer GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  sha256 text NOT NULL UNIQUE,
  name text NOT NULL,
  manifest text NOT NULL,
  signature bytea NOT NULL,
  bytes bigint NOT NULL,
  offered timestamptz NOT NULL DEFAULT now()
);
CREATE TABLE release_parts (
  release integer NOT NULL REFERENCES releases (number) ON DELETE CASCADE,
  at bigint NOT NULL,
  bytes bytea NOT NULL,
  PRIMARY KEY (release, at)
);
-- The cells that a release is for.
CREATE TABLE release_cells (
  release integer NOT NULL REFERENCES releases (number) ON DELETE CASCADE,
  cell text NOT NULL,
  PRIMARY KEY (release, cell)
);
-- What each cell said last.
CREATE TABLE cell_releases (
  cell text PRIMARY KEY,
  has text[] NOT NULL,
  current text NOT NULL,
  switch integer NOT NULL,
  fault text NOT NULL,
  clock_off_ms bigint NOT NULL,
  heard timestamptz NOT NULL
);
-- Planned: cells are told.  Sure: all know, nothing stops it.  Withdrawn: not all knew in time.
CREATE TABLE switches (
  number integer GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  release integer NOT NULL REFERENCES releases (number),
  at timestamptz NOT NULL,
  state text NOT NULL CHECK (state IN ('planned', 'sure', 'withdrawn'))
);
CREATE UNIQUE INDEX one_planned_switch ON switches (state) WHERE state = 'planned';
