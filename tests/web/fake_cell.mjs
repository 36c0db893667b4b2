// SPDX-License-Identifier: MIT
// A small stand-in for biteline-web: the API's answers as openapi.yaml describes them, kept in memory.
// Nothing here is measured or decided: it only lets the page be tried without a cell.
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { join } from 'node:path';

const types = { html: 'text/html; charset=utf-8', js: 'text/javascript', css: 'text/css', svg: 'image/svg+xml', json: 'application/json', png: 'image/png' };
const policy =
  "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; frame-src 'self'; worker-src 'self'";

/// A page that lives on slow events shows where the tests are in a race with it.
const events_late_ms = Number(process.env.BITELINE_TEST_EVENTS_LATE_MS ?? 0);

const refused_gates = [
  { reason_code: 'no_crease', measure: 'evidence', value: 0.42, at_least: 0.1, sure: 1 },
  { reason_code: 'no_crease_all_round', measure: 'longest_gap_mm', value: 128.4, at_most: 100, sure: 0.03 },
  { reason_code: 'no_upper', measure: 'upper_share', value: 0.97, at_least: 0.8, sure: 0.99 },
];

/// A made shoe: an oval wall of 280 x 100 mm over a step of 4 mm, in the shoe's own frame; base is 300 mm away.
export function made_view({ weak = true, found = true } = {}) {
  const places = [];
  const at = (a) => [140 + 140 * Math.cos(a), (50 + 8 * Math.cos(a)) * Math.sin(a) + 6 * Math.max(0, Math.cos(a)) ** 3];
  for (let i = 0; i < 1500; ++i) {
    const a = (2 * Math.PI * i) / 1500;
    const [x, y] = at(a);
    for (let z = 0; z < 70; z += 2) {
      const out = z < 24 ? 4 : -0.1 * (z - 24);
      places.push(x + out * Math.cos(a) + 300, y + out * Math.sin(a), z);
    }
    for (let out = 0; out < 4; out += 1) places.push(x + out * Math.cos(a) + 300, y + out * Math.sin(a), 24);
  }
  const course = (z) => [...Array(300).keys()].map((i) => (2 * Math.PI * i) / 300).map((a) => [at(a)[0] + 300, at(a)[1], z]);
  const origin = [150, -120, -5];
  const step = 0.01;
  const packed = Buffer.alloc(2 * places.length);
  places.forEach((v, i) => {
    packed.writeUInt16LE(Math.round((v - origin[i % 3]) / step), 2 * i);
  });
  const line = { xyz_mm: [], normal: [], confidence: [], u95_mm: [], source: [] };
  for (let i = 0; i < 1200; ++i) {
    const a = (2 * Math.PI * i) / 1200;
    const [x, y] = at(a);
    const is_weak = weak && i > 300 && i < 330;
    line.xyz_mm.push([x + 300, y, 24]);
    line.normal.push([Math.cos(a), Math.sin(a), 0]);
    line.confidence.push(is_weak ? 0.4 : 0.95);
    line.u95_mm.push(is_weak ? 1.4 : 0.15);
    line.source.push(is_weak ? 'bridged' : 'seen');
  }
  const stretch = { place: 'left side, in the middle', from_mm: 155, to_mm: 170, length_mm: 15, reason_code: 'rivalled', alternatives: [{ candidate: 2, off_mm: 3.24, points: [...Array(9).keys()].map((i) => [428 + 3 * i, 58 + 3.24 * Math.sin((Math.PI * i) / 8), 26]) }], least_confidence: 0.4, u95_mm: 1.4, u95_is_guessed: false, middle_mm: [440, 58, 24] };
  return {
    schema_version: 1,
    title: 'Bite line',
    summary: found ? 'bite line found' : 'refused: no crease',
    found,
    report: {
      length_mm: 640,
      weak_stretches: weak ? [stretch] : [],
      candidates: [
        { confidence: 0.96, mean_height_mm: 24, length_mm: 640, crease_deg: 30, seen_share: 0.98 },
        { confidence: 0.03, mean_height_mm: 40, length_mm: 622, crease_deg: 8, seen_share: 0.8 },
      ],
      ...(found ? {} : { reason: 'no crease', next_step: 'push the sole on, or transfer the line of a sample', lack: 2, gates: refused_gates }),
    },
    T_base_shoe: [1, 0, 0, 300, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
    inner_side: 'left',
    cloud: { of: places.length / 3, every: 1, origin_mm: origin, step_mm: step, xyz_u16: packed.toString('base64') },
    ...(found ? { line } : { candidates: [{ points: course(24), lacks: course(24).map((_, i) => (i < 60 ? 2 : 0)) }, { points: course(40) }] }),
  };
}

const upkeep = { starts: 12, boots: 3, run_s: 469800, laser_s: 51120, lightings: 512, frames: 3000000, coldest_degc: 18.5, hottest_degc: 46.25 };
const passwords = { anna: 'correct horse', otto: 'battery staple', vera: 'only looking' };
const schema = {
  type: 'object',
  required: ['name', 'tool', 'motion'],
  properties: {
    name: { type: 'string', description: 'words' },
    tool: {
      type: 'object',
      required: ['tcp_position_mm'],
      properties: {
        tcp_position_mm: { type: 'array', minItems: 3, maxItems: 3, description: 'tip in the flange', items: { type: 'number', minimum: -1000, maximum: 1000, 'x-unit': 'mm' } },
        free_turn_deg: { type: 'number', minimum: 0, maximum: 180, 'x-unit': 'degrees', description: 'how far it may turn about its axis' },
      },
    },
    placement: {
      type: 'object',
      properties: {
        outward_mm: { type: 'number', minimum: -50, maximum: 200, 'x-unit': 'mm' },
        up_mm: { type: 'number', minimum: -50, maximum: 200, 'x-unit': 'mm' },
        standoff_mm: { type: 'number', minimum: 0, maximum: 500, 'x-unit': 'mm' },
        tilt_deg: { type: 'number', minimum: -45, maximum: 90, 'x-unit': 'degrees' },
        lead_deg: { type: 'number', minimum: -60, maximum: 60, 'x-unit': 'degrees' },
      },
    },
    motion: {
      type: 'object',
      properties: {
        speed_mm_s: { type: 'number', minimum: 0.1, maximum: 1000, 'x-unit': 'mm/s', description: 'along the line' },
      },
    },
    zones: {
      type: 'array',
      maxItems: 20,
      description: 'stretches of the line that are worked in another way',
      items: {
        type: 'object',
        required: ['name'],
        properties: {
          name: { type: 'string', description: 'words' },
          where: { enum: ['stretch', 'heel', 'toe'], default: 'stretch', description: 'the place' },
          outward_by_mm: { type: 'number', minimum: -50, maximum: 50, 'x-unit': 'mm', description: 'further out' },
          passes: { type: 'integer', minimum: 1, maximum: 10, description: 'how often' },
        },
      },
    },
    start: { enum: ['auto', 'nearest', 'farthest'], default: 'auto', description: 'where the path begins' },
  },
};

export class FakeCell {
  constructor(page) {
    this.page = page;
    this.local = true;
    /// How long a check of a process takes, and how many were under way at once.
    this.check_takes_ms = 0;
    /// The answer about control comes so late; its event does not.
    this.control_answer_ms = 0;
    this.control_answers = 0;
    this.checks = 0;
    this.most_checks = 0;
    this.view_fails = false;
    this.mounted = { version: 0, tool: null, shelf: {}, tip: null, payload: null, lines: null, renewed: null, table: null, lesson: null, controller: null, wear: {} };
    /// So long the gate lets the scan that waits through; null: not at all.
    this.fresh_s = 95;
    this.calls = [];
    this.reruns = new Map();
    this.sessions = new Map();
    this.process_files = new Map();
    this.sockets = new Set();
    this.seq = 1;
    this.control = { holder: null };
    this.view = made_view();
    const row = (id, verdict, decision, more = {}) => ({
      id, time: '2026-11-20T10:00:00Z', verdict, decision, decided_by: null, why: null, model: 'runner-42', process: 'rough', reason_code: null, reason: null,
      next_step: null, length_mm: 640.2, confidence: 0.96, u95_mm: 0.31, weak_stretches: 0, scan_s: 9.1, line_s: 0.05, cycle_s: 31.5, sent: false, followed: null,
      operator: 'anna', version: '0.1.0', line_version: 0, kept: false, ...more,
    });
    this.scans = [
      row('scan-0004', 'amber', 'held', { u95_mm: 1.4, weak_stretches: 1, reason: 'weak on the left side' }),
      row('scan-0003', 'refused', 'open', { reason_code: 'no_crease', reason: 'no crease: nothing concave runs round the side', next_step: 'push the sole on, or transfer the line of a sample', length_mm: null, u95_mm: null, weak_stretches: null, confidence: 0.1 }),
      row('scan-0002', 'ok', 'automatic', { sent: true, followed: true, part: 'A-17', foot: 'left', size: 'EU 42' }),
      row('scan-0001', 'ok', 'accepted', { decided_by: 'anna', length_mm: 631.7 }),
    ];
    this.trends = [...Array(10).keys()].map((i) => ({ time: new Date(Date.UTC(2026, 10, 10 + i)).toISOString(), scans: 20 + i, ok: 16 + i, amber: 2, review: 0, refused: 1, failed: 1, cycle_s: 30 + Math.sin(i), u95_mm: 0.3 + 0.02 * i, length_mm: 640 }));
    this.models = [{ name: 'runner-42', time: '2026-11-19T09:00:00Z', scan: 'scan-0001', process: 'rough', size: 'EU 42', foot: 'left', version: 1, length_mm: 631.72, scans: 12 }];
    this.users = [
      { name: 'anna', role: 'administrator', enabled: true, made: '2026-11-01T08:00:00Z', last_login: '2026-11-20T08:00:00Z' },
      { name: 'otto', role: 'operator', enabled: true, made: '2026-11-02T08:00:00Z', last_login: null },
      { name: 'vera', role: 'viewer', enabled: true, made: '2026-11-02T08:00:00Z', last_login: null },
    ];
    this.settings = [
      { key: 'camera.exposure_us', value: '250 us', now: 250, kind: 'number', unit: 'us', what: 'How long each picture is exposed', range: [1, 1e7] },
      { key: 'camera.gain', value: 'as the camera has it', now: null, kind: 'number', unit: '', what: 'The camera\'s own number', range: [0, 65535] },
      { key: 'camera.follow_stripe', value: 'off', now: false, kind: 'on_off', unit: '', what: 'Only the rows about the stripe are taken' },
      { key: 'region.height_px', value: '400 px', now: 400, kind: 'whole', unit: 'px', what: 'Rows; fewer are faster', range: [16, 16384] },
      { key: 'peaks.choice', value: 'continuity', now: 'continuity', kind: 'word', unit: '', what: 'Which of several peaks in a column', words: ['continuity', 'first', 'last', 'strongest'] },
    ];
    this.process = { name: 'rough', tool: { tcp_position_mm: [0, 0, 120], free_turn_deg: 20 }, placement: { outward_mm: 0, up_mm: 1.5, standoff_mm: 0, tilt_deg: 30, lead_deg: 0 }, motion: { speed_mm_s: 60 }, start: 'auto' };
    this.state = {
      version: '0.1.0', simulated: true, phase: 'deciding', now: 'scan-0004 waits for a person', next: 'send the path, or scan again', next_code: 'accept_or_reject', scan: 'scan-0004', progress: 0.7,
      lamps: {
        laser: { level: 'off', words: 'off: dark', code: 'laser_off', detail: '' }, camera: { level: 'ok', words: 'connected', code: 'camera_connected', detail: '' }, robot: { level: 'warning', words: 'not in remote control: switch it on the pendant', code: 'robot_wrong', detail: 'not in remote control: switch it on the pendant' },
        poses: { level: 'ok', words: 'come in', code: 'poses_flow', detail: '' }, clock: { level: 'fault', words: 'not known yet: controller', code: 'clock_unknown', detail: 'controller' },
      },
      cycle: { this_s: 12.3, last_s: 31.5 }, model: { name: 'runner-42', probability: 0.98 }, process: 'rough', control: this.control, seq: 1,
    };
  }

  async listen(port = 0) {
    this.server = createServer((request, response) => this.answer(request, response));
    this.server.on('upgrade', (request, socket) => this.upgrade(request, socket));
    await new Promise((done) => this.server.listen(port, '127.0.0.1', done));
    this.port = this.server.address().port;
    return `http://127.0.0.1:${this.port}/`;
  }

  /// As a killed server: every connection is cut.
  async stop() {
    for (const { socket } of this.sockets) socket.destroy();
    this.sockets.clear();
    this.server.closeAllConnections?.();
    await new Promise((done) => this.server.close(done));
  }

  user(request) {
    const session = /biteline_session=(\w+)/.exec(request.headers.cookie ?? '')?.[1];
    const name = this.sessions.get(session);
    return this.users.find((user) => user.name === name) ?? null;
  }

  upgrade(request, socket) {
    if (!this.user(request)) {
      socket.end('HTTP/1.1 401 Unauthorized\r\n\r\n');
      return;
    }
    const key = createHash('sha1').update(`${request.headers['sec-websocket-key']}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`).digest('base64');
    socket.write(`HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${key}\r\n\r\n`);
    const kept = { socket, live: request.url.endsWith('/live') };
    this.sockets.add(kept);
    socket.on('close', () => this.sockets.delete(kept));
    socket.on('error', () => this.sockets.delete(kept));
  }

  frame(bytes, opcode) {
    const head = bytes.length < 126 ? Buffer.from([0x80 | opcode, bytes.length]) : Buffer.alloc(bytes.length < 65536 ? 4 : 10);
    if (bytes.length >= 126) {
      head[0] = 0x80 | opcode;
      head[1] = bytes.length < 65536 ? 126 : 127;
      if (bytes.length < 65536) head.writeUInt16BE(bytes.length, 2);
      else head.writeBigUInt64BE(BigInt(bytes.length), 2);
    }
    return Buffer.concat([head, bytes]);
  }

  told_state() {
    const held = this.scans.find((scan) => scan.decision === 'held');
    const sendable = this.fresh_s !== 0 && !this.not_sendable;
    const offers = held ? ['rescan', 'reject', 'process', 'mend', ...(sendable ? ['accept', 'air'] : []), ...(this.may_look ? ['look'] : [])] : ['start', 'rescan'];
    return { ...this.state, offers, held: held ? { scan: held.id, waits_for: 'word', fresh_s: this.fresh_s, sendable, reason_code: null, reason: this.not_sendable ?? null, next_step: this.not_sendable ? 'scan the shoe again' : null, tool: this.tool_wanted ?? null } : null, control: this.control, seq: this.seq };
  }
  /// As POST /commands/start with `hold`.
  begin_teaching(who) {
    const id = (this.teaching?.id ?? 0) + 1;
    this.teaching = { id, begun: new Date().toISOString(), begun_by: who, scan: null, scans_before: [], process: null, process_by: null, dry_run: null, air: null, followed: null, model: null, ended: null, ended_by: null, ended_how: null };
  }
  end_teaching(how, who) {
    Object.assign(this.teaching, { ended: new Date().toISOString(), ended_by: who, ended_how: how });
  }
  /// Facts, and the steps that follow of them, as the service makes them.
  told_teaching() {
    const teaching = this.teaching;
    const held = this.scans.find((scan) => scan.decision === 'held');
    if (!teaching.ended && held && held.id !== teaching.scan) {
      if (teaching.scan) teaching.scans_before.push(teaching.scan);
      teaching.scan = held.id;
    }
    const scan = this.scans.find((row) => row.id === teaching.scan);
    const work = { scan: teaching.scan, line_version: scan?.line_version ?? 0, process_sha256: scan ? createHash('sha256').update(scan.process).digest('hex') : null };
    const process_by = scan?.decision === 'held' ? (this.state.process_by ?? null) : teaching.process_by;
    const other = (done) => (!done ? 'not' : done.scan !== work.scan ? 'scanned_again' : done.line_version !== work.line_version ? 'line_changed' : done.process_sha256 !== work.process_sha256 ? 'process_changed' : null);
    const air = other(teaching.followed);
    const dry_run = air && other(teaching.dry_run);
    const why = [scan ? null : 'no_scan', scan ? null : 'no_line', process_by ? null : 'not_chosen', dry_run === 'not' ? 'not_seen' : dry_run, air === 'not' ? 'not_run' : air, teaching.model ? null : 'not_saved'];
    const next = teaching.ended ? -1 : why.findIndex((one) => one);
    const names = ['scan', 'line', 'process', 'dry_run', 'air', 'model'];
    const steps = names.map((step, i) => ({ step, state: i === next ? 'now' : why[i] ? 'open' : 'done', why: why[i] }));
    return { ...teaching, ...work, process: scan?.process ?? null, process_by, step: names[next] ?? null, steps };
  }
  push(event, data) {
    const text = JSON.stringify({ event, data, seq: ++this.seq, time: new Date().toISOString() });
    const send = () => {
      for (const { socket, live } of this.sockets) if (!live) socket.write(this.frame(Buffer.from(text), 1));
    };
    if (events_late_ms > 0) setTimeout(send, events_late_ms);
    else send();
  }

  push_live(bytes) {
    for (const { socket, live } of this.sockets) if (live) socket.write(this.frame(bytes, 2));
  }

  answer(request, response) {
    let body = '';
    request.on('data', (part) => {
      body += part;
    });
    request.on('end', async () => {
      const url = new URL(request.url, 'http://cell');
      if (!url.pathname.startsWith('/api/v1/')) return this.serve_page(url.pathname, response);
      const path = url.pathname.slice('/api/v1'.length);
      const given = body && request.headers['content-type'] === 'application/json' ? JSON.parse(body) : {};
      this.calls.push({ method: request.method, path, body: given });
      if (path === '/processes/check') {
        this.most_checks = Math.max(this.most_checks, ++this.checks);
        await new Promise((done) => setTimeout(done, this.check_takes_ms));
        this.checks -= 1;
      }
      const result = this.decide(request, path, given, url.searchParams, body);
      if (path === '/control') await new Promise((done) => setTimeout(done, this.control_answer_ms));
      const [status, value, headers = {}] = result;
      const is_text = typeof value === 'string' || Buffer.isBuffer(value);
      response.writeHead(status, { 'content-type': is_text ? (headers['content-type'] ?? 'text/plain') : 'application/json', 'content-security-policy': policy, ...headers });
      response.end(status === 204 ? undefined : is_text ? value : JSON.stringify(value));
      if (path === '/control') this.control_answers += 1;
    });
  }

  serve_page(path, response) {
    try {
      const name = path === '/' ? 'index.html' : path.slice(1).replace(/\.\./g, '');
      const content = readFileSync(join(this.page, name));
      response.writeHead(200, { 'content-type': types[name.split('.').pop()] ?? 'application/octet-stream', 'content-security-policy': policy });
      response.end(content);
    } catch {
      response.writeHead(404, { 'content-type': 'text/plain' });
      response.end('not found');
    }
  }

  /// As the service does: each touch makes the tip better known; the fourth is enough.
  teach_mounted(method, part, given, me, fail) {
    const mounted = this.mounted;
    if (method === 'GET') return [200, mounted];
    if (this.control.holder !== me.name) return fail(409, 'control_needed', 'take control first');
    const how = { version: mounted.version + 1, who: me.name, time: new Date().toISOString() };
    if (part === '/touches') {
      const lesson = mounted.lesson?.part === given.part ? mounted.lesson : { part: given.part, touches: 0 };
      lesson.touches += given.take_back ? -1 : 1;
      const ready = lesson.touches >= (given.part === 'tip' ? 4 : 3);
      Object.assign(lesson, {
        at_mm: ready && given.part === 'tip' ? [0.12, -0.31, 180.2] : null, z_mm: ready && given.part === 'table' ? -12.1 : null,
        residual_mm: ready ? 0.12 : null, u95_mm: ready ? 0.2 : null, missing: ready ? null : `${lesson.touches} touches, more needed`,
      });
      mounted.lesson = method === 'DELETE' || lesson.touches === 0 ? null : lesson;
      mounted.controller = { tip_mm: [0, 0, 180], payload_kg: null, payload_centre_mm: null, carries_as_taught: null };
      return [200, mounted];
    }
    const name = part.slice(1);
    mounted.version += 1;
    if (method === 'DELETE') mounted[name] = null;
    else if (name === 'tool') {
      if (mounted.tool) mounted.shelf[mounted.tool.name] = { tip: mounted.tip, payload: mounted.payload, lines: mounted.lines, renewed: mounted.renewed };
      mounted.tool = { ...how, name: given.name };
      if (this.tool_wanted === given.name) {
        this.tool_wanted = this.not_sendable = null;
        this.push('state', this.told_state());
      }
    } else if (name === 'renewed') {
      mounted.renewed = how;
    } else if (name === 'lines') {
      mounted.lines = { ...how, ...given };
    } else if (name === 'payload') {
      mounted.payload = { ...how, kg: given.kg, centre_mm: given.centre_mm };
      mounted.controller = { tip_mm: [0, 0, 180], payload_kg: 0.5, payload_centre_mm: [0, 0, 20], carries_as_taught: false };
    } else {
      const { touches, residual_mm, u95_mm, at_mm, z_mm } = mounted.lesson;
      mounted[name] = { ...how, touches, residual_mm, u95_mm, ...(name === 'tip' ? { at_mm } : { z_mm }) };
      mounted.lesson = null;
    }
    return [200, mounted];
  }

  decide(request, path, given, asked, body) {
    const fail = (status, code, message, faults) => [status, { error: { code, message, ...(faults ? { faults } : {}) } }];
    const me = this.user(request);
    const method = request.method;
    if (path === '/sessions' && method === 'POST') {
      if (given.token ? given.token !== 'one-time' : passwords[given.name] !== given.password) return fail(401, 'wrong_password', 'name or password is wrong');
      const id = createHash('sha256').update(`${Math.random()}`).digest('hex').slice(0, 32);
      this.sessions.set(id, given.token ? 'vera' : given.name);
      return [201, { expires: '2026-11-21T00:00:00Z', user: { name: given.name ?? 'vera', role: 'viewer' } }, { 'set-cookie': `biteline_session=${id}; HttpOnly; SameSite=Strict; Path=/` }];
    }
    if ((path === '/commands/stop' || path === '/commands/laser-off') && (this.local || me)) return [200, { done: true }];
    if (!me) return fail(401, 'login_needed', 'log in');
    if (path === '/sessions') return [204, null];
    if (path === '/me') return [200, { name: me.name, role: me.role, control: this.control.holder === me.name, local: this.local }];
    if (path === '/state') return [200, this.told_state()];
    if (path === '/control') {
      if (method === 'POST') {
        if (given.action === 'take') this.control = { holder: me.name, door: 'web', since: new Date().toISOString(), why: given.why };
        if (given.action === 'release') this.control = { holder: null };
        if (given.action === 'give') this.control = { holder: given.to, door: 'web' };
        this.push('control', this.control);
      }
      return [200, this.control];
    }
    if (path === '/scans') {
      const verdict = asked.get('verdict');
      const reason = asked.get('reason_code');
      const part = asked.get('part')?.replace(/\*$/, '');
      const wanted = (scan) => (!verdict || scan.verdict === verdict) && (!reason || scan.reason_code === reason) && (!part || scan.part?.startsWith(part));
      return [200, { scans: this.scans.filter(wanted), next: null }];
    }
    const scan_path = /^\/scans\/(scan-\d+)(?:\/(.*))?$/.exec(path);
    if (scan_path) {
      const scan = this.scans.find((row) => row.id === scan_path[1]);
      if (!scan) return fail(404, 'not_found', `${scan_path[1]}: no such scan`);
      const what = scan_path[2];
      if (!what) return [200, { ...scan, report: scan.verdict === 'refused' ? { status: 'refused', gates: refused_gates } : { status: 'ok' }, gate: null, follow: null, air: this.air ?? null, process_file: this.process_files.get(scan.id) ?? null, versions: [{ version: 0, time: scan.time, who: 'found' }], reruns: this.reruns.get(scan.id) ?? [] }];
      if (what === 'files') return [200, { files: (scan.verdict === 'refused' ? ['cloud.ply', 'report.json'] : ['line.csv', 'cloud.ply', 'report.json', 'path/tracking.html']).map((name) => ({ path: name, bytes: 12345, time: scan.time })) }];
      if (what === 'files/view_data.js') {
        if (this.view_fails) return fail(500, 'internal', 'the disk does not answer');
        const found = scan.verdict !== 'refused';
        return [200, `window.biteline_view = ${JSON.stringify(found ? this.view : made_view({ weak: false, found: false }))};\n`, { 'content-type': 'text/javascript' }];
      }
      if (what === 'files/line.csv') return [200, `x_mm,y_mm,z_mm\n${this.view.line.xyz_mm.map((p) => p.join(',')).join('\n')}\n`];
      if (what.startsWith('files/')) return [200, 'a file'];
      if (this.control.holder !== me.name) return fail(409, 'control_needed', 'take control first');
      if (what === 'model') {
        Object.assign(scan, { model: given.model, reason_code: null, reason: null });
        this.push('scan', scan);
        return [202, { done: false }];
      }
      if (what === 'process' || what === 'air') {
        this.state = { ...this.state, phase: what === 'air' ? 'following' : 'working' };
        this.push('state', this.told_state());
        setTimeout(() => {
          if (what === 'process') {
            scan.process = given.process;
            this.process_files.set(scan.id, given.process);
            Object.assign(this.state, { process: given.process, process_by: me.name });
          }
          if (what === 'air' && this.teaching) {
            const { scan: id, line_version, process_sha256 } = this.told_teaching();
            this.teaching.followed = { scan: id, line_version, process_sha256, who: me.name, time: new Date().toISOString(), state: 'followed' };
            this.teaching.air = this.teaching.followed;
          }
          if (what === 'air') this.air = { state: 'followed', reason_code: null, reason: null, next_step: null, duration_s: 161.2 };
          this.state = { ...this.state, phase: 'deciding' };
          this.push('scan', scan);
          this.push('state', this.told_state());
        }, 300);
        return [202, { done: false, words: 'begun' }];
      }
      if (what === 'look') {
        this.looks = (this.looks ?? 0) + 1;
        return [202, { done: false, words: 'the sensor looks' }];
      }
      if (what === 'rerun') {
        const made = { rerun: 1, time: scan.time, who: me.name, why: given.why, settings: given.settings, state: 'working' };
        this.reruns.set(scan.id, [made]);
        return [202, made];
      }
      if (what === 'mend') {
        scan.line_version = given.line_version + 1;
        this.push('scan', scan);
        return [200, scan];
      }
      // As the service does: what was said of a scan changes what waits.
      setTimeout(() => this.push('state', this.told_state()), 0);
      Object.assign(scan, { decision: { accept: 'accepted', reject: 'rejected', hold: 'held' }[what] ?? scan.decision, decided_by: me.name, why: given.why ?? null });
      this.push('scan', scan);
      return [200, scan];
    }
    if (path === '/sensors/settings') {
      if (me.role !== 'administrator' && me.role !== 'engineer') return fail(403, 'not_allowed', 'this needs the role engineer');
      if (this.control.holder !== me.name) return fail(409, 'control_needed', 'take control first');
      // As a sensor: all of it or nothing; the region stays while a scan is on; the camera's step is 10 us.
      if ('region.height_px' in given.settings)
        return fail(409, 'refused', 'region.height_px: it stays 400 px while a scan is on; stop the scan first');
      for (const row of this.settings) {
        if (!(row.key in given.settings)) continue;
        row.now = row.key === 'camera.exposure_us' ? 10 * Math.round(given.settings[row.key] / 10) : given.settings[row.key];
        row.value = row.unit ? `${row.now} ${row.unit}` : String(row.now);
      }
      return [200, { done: true }];
    }
    if (path === '/sensors/keep') {
      if (this.control.holder !== me.name) return fail(409, 'control_needed', 'take control first');
      // As a sensor: one scan waits, and only once.
      if (given.which === 'next') return [200, { done: true, words: 'kept: the scan that ends next, as /var/lib/biteline/scan' }];
      if (this.last_kept) return fail(409, 'refused', '/var/lib/biteline/scan-last: no scan waits there');
      this.last_kept = true;
      return [200, { done: true, words: 'kept: /var/lib/biteline/scan-2' }];
    }
    if (path === '/teachings') return [200, { teachings: this.teaching ? [this.told_teaching()] : [], next: null }];
    if (path.startsWith('/teachings/')) {
      if (path.split('/')[2] !== String(this.teaching?.id)) return fail(404, 'not_found', 'no such teaching');
      if (method === 'GET') return [200, this.told_teaching()];
      if (this.control.holder !== me.name) return fail(409, 'control_needed', 'take control first');
      if (method === 'DELETE') this.end_teaching('given_up', me.name);
      else {
        const { scan, line_version, process_sha256 } = this.told_teaching();
        this.teaching.dry_run = { scan, line_version, process_sha256, who: me.name, time: new Date().toISOString() };
      }
      this.push('teaching', this.told_teaching());
      return method === 'DELETE' ? [204, null] : [200, this.told_teaching()];
    }
    if ((path === '/commands/start' || path === '/commands/rescan') && this.control.holder === me.name) {
      const open = this.teaching && !this.teaching.ended;
      if (!given.hold && open) this.end_teaching('given_up', me.name);
      if (given.hold && !(open && path === '/commands/rescan')) this.begin_teaching(me.name);
      if (this.teaching) this.push('teaching', this.told_teaching());
      return [202, { done: false }];
    }
    if (path.startsWith('/commands/')) return this.control.holder === me.name ? [202, { done: false }] : fail(409, 'control_needed', 'take control first');
    if (path === '/models' && method === 'POST') {
      const taught = this.teaching && given.scan === this.teaching.scan ? this.told_teaching() : null;
      if (taught && !given.not_run && taught.steps[4].state !== 'done') return fail(409, 'wrong_state', `${given.scan} was not run in the air yet`);
      this.models.push({ ...given, version: 1, time: new Date().toISOString() });
      if (taught) {
        this.teaching.model = given.name;
        this.end_teaching('saved', me.name);
        this.push('teaching', this.told_teaching());
      }
      return [201, this.models.at(-1)];
    }
    if (path === '/models') return [200, { models: this.models, release: this.release ?? null }];
    if (path === '/model-files') {
      if (this.control.holder !== me.name) return fail(409, 'control_needed', 'take control first');
      if (!body.startsWith('the archive of ')) return fail(400, 'bad_request', 'the file: no tar file, or a damaged one');
      const name = asked.get('name') ?? body.slice('the archive of '.length);
      if (this.models.some((model) => model.name === name) && asked.get('replace') !== 'true') return fail(409, 'exists', `model ${name} exists; say replace, or choose another name`);
      this.models = [...this.models.filter((model) => model.name !== name), { name, version: 1, time: new Date().toISOString() }];
      this.push('model', this.models.at(-1));
      return [201, this.models.at(-1)];
    }
    if (/^\/models\/[^/]+\/file$/.test(path)) return [200, `the archive of ${path.split('/')[2]}`, { 'content-type': 'application/x-tar' }];
    if (path.startsWith('/models/') && method === 'DELETE') {
      this.models = this.models.filter((model) => `/models/${model.name}` !== path);
      return [204, null];
    }
    if (path === '/processes') return [200, { processes: [{ name: 'rough', shipped: true, time: null, who: null }, { name: 'cement', shipped: true, time: null, who: null }], release: this.release ?? null }];
    if (path === '/processes/schema') return [200, schema];
    if (path === '/processes/check') {
      const speed = given.process.motion?.speed_mm_s;
      if (speed > 200) return fail(422, 'check_failed', 'motion.speed_mm_s: too fast for this tool', [{ field: 'motion.speed_mm_s', message: 'at most 200 with this tool' }]);
      const fits = speed <= 100;
      return [200, { scan: 'scan-0004', fits, duration_s: fits ? 16.6 : null, reason_code: fits ? null : 'cannot_follow', reason: fits ? null : 'joint 4 turns too fast', next_step: fits ? null : 'go slower' }];
    }
    if (path.startsWith('/processes/')) {
      if (method === 'PUT') {
        if (given.motion?.speed_mm_s > 200) return fail(422, 'check_failed', 'motion.speed_mm_s: too fast for this tool', [{ field: 'motion.speed_mm_s', message: 'at most 200 with this tool' }]);
        this.process = given;
      }
      return [200, { name: 'rough', shipped: true, process: this.process }];
    }
    if (path.startsWith('/mounted')) return this.teach_mounted(method, path.slice('/mounted'.length), given, me, fail);
    if (path === '/robots') return [200, { robots: [{ name: 'UR5e', address: '127.0.0.1', serial: '2022', connected: true, powered: true, remote: false, ready: false, words: 'not in remote control: switch it on the pendant' }] }];
    if (path === '/sensors') {
      return [200, {
        sensors: [{ name: 'sensor', connected: true, scanning: false, laser: 'off', laser_reason: '', camera_connected: true, poses_flow: true, realtime: true, temperature_degc: 41.5, frames: 60593, frames_lost: 0, frames_damaged: 0, profiles: 60593, profiles_dropped: 2, messages_lost: 0, poses_lost: 0, overruns: 0, version: '0.1.0', upkeep, fault: 'camera silent', next_step: 'look at its cable', clocks: [{ name: 'camera', known: true, offset_ns: 1234567, uncertainty_ns: 2100, drift_ppm: 3.2, steps: 0 }] }],
        disk: { free_bytes: 31e9, total_bytes: 64e9 },
      }];
    }
    if (path === '/users' && me.role !== 'administrator') return fail(403, 'not_allowed', 'an administrator may');
    if (path === '/users' && method === 'POST') {
      this.users.push({ name: given.name, role: given.role, enabled: true, made: new Date().toISOString(), last_login: null });
      return [201, this.users.at(-1)];
    }
    if (path === '/users') return [200, { users: this.users }];
    if (path.startsWith('/users/')) return [200, Object.assign(this.users.find((user) => `/users/${user.name}` === path) ?? {}, given)];
    if (path === '/log') return [200, { entries: [{ seq: 2, time: '2026-11-20T10:01:00Z', who: 'anna', door: 'web', what: 'accept', subject: 'scan-0001', before: { decision: 'open' }, after: { decision: 'accepted' } }], next: null }];
    if (path === '/history/trends') {
      const places = [...Array(36).keys()];
      return [200, { buckets: this.trends, reasons: [{ reason_code: 'no_crease', scans: 6, ended_by: 'shoe' }, { reason_code: 'no_poses', scans: 4, ended_by: 'machine' }], ended_by: { person: 1, machine: 4, shoe: 6 }, capability: { model: 'runner-42', tolerance_mm: 0.5, scans: 90, pp: places.map((i) => 1.8 + 0.2 * Math.sin(i)), ppk: places.map((i) => 1.5 + 0.3 * Math.sin(i)) } }];
    }
    return fail(404, 'not_found', `${path}: no such thing`);
  }
}

/// Live messages as openapi.yaml's /live lays them out.
export const live = {
  profile(seq) {
    const count = 400;
    const bytes = Buffer.alloc(15 + 9 * count);
    bytes[0] = 2;
    bytes.writeUInt32LE(seq, 1);
    bytes.writeUInt16LE(count, 13);
    for (let i = 0; i < count; ++i) {
      bytes.writeFloatLE(-40 + 0.2 * i, 15 + 9 * i);
      bytes.writeFloatLE(10 * Math.sin(i / 60), 19 + 9 * i);
      bytes[23 + 9 * i] = i > 380 ? 1 : 0;
    }
    return bytes;
  },
  cloud(scan, count) {
    const bytes = Buffer.alloc(9 + 20 * count);
    bytes[0] = 3;
    bytes.writeUInt32LE(scan, 1);
    bytes.writeUInt32LE(count, 5);
    for (let i = 0; i < count; ++i) {
      const a = (2 * Math.PI * i) / 500;
      [400 + 140 * Math.cos(a), 50 * Math.sin(a), i / 100, i % 50 === 0 ? Number.NaN : 0.2 * Math.sin(3 * a), 0.02 + 0.02 * Math.cos(a)].forEach((v, k) => {
        bytes.writeFloatLE(v, 9 + 20 * i + 4 * k);
      });
    }
    return bytes;
  },
  line(count) {
    const bytes = Buffer.alloc(5 + 20 * count);
    bytes[0] = 4;
    bytes.writeUInt32LE(count, 1);
    for (let i = 0; i < count; ++i) {
      const a = (2 * Math.PI * i) / count;
      [400 + 142 * Math.cos(a), 52 * Math.sin(a), 24, 0.9, 0.2].forEach((v, k) => {
        bytes.writeFloatLE(v, 5 + 20 * i + 4 * k);
      });
    }
    return bytes;
  },
  arm(x_mm) {
    const bytes = Buffer.alloc(81);
    bytes[0] = 5;
    [0, 0, -1.5, 1.5, -1.5, -1.5, 0, x_mm, 60, 40].forEach((v, i) => {
      bytes.writeDoubleLE(v, 1 + 8 * i);
    });
    return bytes;
  },
  /// A stripe as the picture of page_test shows it: 640 x 400 px of the sensor from 100, 40 on.
  peaks(seq) {
    const count = 640;
    const bytes = Buffer.alloc(17 + 7 * count);
    bytes[0] = 6;
    bytes.writeUInt32LE(seq, 1);
    [100, 40, 640, 400, 1, count].forEach((v, i) => bytes.writeUInt16LE(v, 5 + 2 * i));
    for (let x = 0; x < count; ++x) {
      bytes.writeUInt16LE(100 + x, 17 + 7 * x);
      bytes.writeFloatLE(40 + 200 + 60 * Math.sin(x / 90), 19 + 7 * x);
      bytes[23 + 7 * x] = x < 20 ? 0x02 : x < 50 ? 0x20 : 0;
    }
    return bytes;
  },
  sensor(cell) {
    const state = {
      name: 'head 3', version: '0.1.0', simulated: false, recording: false, scanning: true, laser: 'on', laser_reason: '',
      region_px: [100, 40, 640, 400], frames: 900, frames_lost: 1, frames_damaged: 0, profiles: 899, observers: 1,
      triggered_by_software: false, temperature_degc: 41.5, rate_max_hz: 123.4, changes: 1, upkeep,
      trigger: { edges: 900, edges_missed: 1, edges_lost: 0, frames_paired: 899, frames_without_edge: 0 },
      settings: cell.settings,
    };
    return Buffer.concat([Buffer.from([7]), Buffer.from(JSON.stringify(state))]);
  },
  picture(seq, jpeg) {
    const head = Buffer.alloc(13);
    head[0] = 1;
    head.writeUInt32LE(seq, 1);
    return Buffer.concat([head, jpeg]);
  },
};
