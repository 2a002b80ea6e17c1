// The page: it reads the stream, keeps the last minutes, and draws the panels of panels/ (docs/host.md).
"use strict";

const KEPT_S = 180, KEPT_ROWS = 300000, KEPT_BYTES = 48 << 20;
const SPANS = [1, 2, 5, 10, 20, 30, 60, 120, 180];

// Rows of numbers in order of time, the oldest dropped.
export class Series {
  constructor(width, most = KEPT_ROWS) {
    this.width = width; this.most = most; this.clear();
  }
  clear() { this.length = 0; this.columns = Array.from({length: this.width + 1}, () => new Float64Array(1024)); }
  push(t, ...values) {
    if (this.length && t < this.columns[0][this.length - 1]) t = this.columns[0][this.length - 1];
    if (this.length === this.columns[0].length) this.grow(t);
    this.columns[0][this.length] = t;
    for (let k = 0; k < this.width; k++) this.columns[k + 1][this.length] = values[k];
    this.length++;
  }
  grow(t) {  // drop what is too old; take more room if that was little
    const first = Math.max(this.at(t - KEPT_S), this.length >= this.most ? this.length >> 1 : 0);
    const left = this.length - first, room = left > this.length / 2 ? 2 * this.columns[0].length : this.columns[0].length;
    this.columns = this.columns.map(column => {
      const found = room === column.length ? column : new Float64Array(room);
      found.set(column.subarray(first, this.length));
      return found;
    });
    this.length = left;
  }
  at(t) {  // index of the first row not before t
    let low = 0, high = this.length;
    while (low < high) { const mid = (low + high) >> 1; if (this.columns[0][mid] < t) low = mid + 1; else high = mid; }
    return low;
  }
  last(t) { return (this.columns[0][this.at(t)] === t && this.at(t) < this.length ? this.at(t) : this.at(t) - 1); }
  // At most `most` points from..to for a chart: of each span the least ("min"), greatest ("max") or last of a column.
  thin(from, to, picks, most = 1200) {
    const first = Math.max(0, this.at(from) - 1), end = Math.min(this.length, this.at(to) + 1);
    const step = Math.max(1, Math.ceil((end - first) / most)), count = Math.ceil((end - first) / step);
    const found = [new Float64Array(count), ...picks.map(() => new Float64Array(count))];
    for (let k = 0; k < count; k++) {
      const a = first + k * step, b = Math.min(end, a + step);
      found[0][k] = this.columns[0][a];
      picks.forEach(([column, how], p) => {
        const values = this.columns[column];
        let value = values[how === "last" ? b - 1 : a];
        if (how === "min") for (let i = a + 1; i < b; i++) { if (values[i] < value) value = values[i]; }
        if (how === "max") for (let i = a + 1; i < b; i++) { if (values[i] > value) value = values[i]; }
        found[p + 1][k] = value;
      });
    }
    return found;
  }
}

// Steps of values: what holds from a time on, by name; nothing is known of the time before the first.
export class Steps {
  constructor() { this.of = new Map(); }
  clear() { this.of.clear(); }
  push(key, t, value) {  // in order of time: a viewer that joins gets the newest first
    const list = this.of.get(key) ?? this.of.set(key, []).get(key);
    let at = list.length;
    while (at && list[at - 1].t > t) at--;
    if (at && list[at - 1].t === t) list[at - 1].value = value;
    else list.splice(at, 0, {t, value});
    let old = 0;
    while (old + 1 < list.length && list[old + 1].t < t - KEPT_S) old++;
    if (old || list.length > 5000) list.splice(0, Math.max(old, list.length - 5000));
  }
  change(key, t, value, before) {  // `before` held from the first moment that this viewer got
    if (!(this.of.get(key)?.[0].t < t) && before !== null && page.first < t) this.push(key, page.first, before);
    this.push(key, t, value);
  }
  now(key) { return this.of.get(key)?.at(-1)?.value; }
  at(key, t) {
    const list = this.of.get(key) ?? [];
    let low = 0, high = list.length;
    while (low < high) { const mid = (low + high) >> 1; if (list[mid].t <= t) low = mid + 1; else high = mid; }
    return list[low - 1]?.value;
  }
  line(key, from, to, pick = value => value) {  // [t, value] for a stepped chart
    const list = this.of.get(key) ?? [], found = [[], []];
    list.forEach(({t, value}, k) => {
      if (t > to || (list[k + 1]?.t ?? Infinity) < from) return;
      found[0].push(t); found[1].push(pick(value));
    });
    if (found[0].length) { found[0].push(to); found[1].push(found[1].at(-1)); }
    return found;
  }
}

export const page = {
  hello: null, first: 0, newest: 0, received: 0,  // of the stream, its first and newest time
  started: false, firstPicture: null,
  view: {paused: false, to: 0, span: 10},
  channel: 0, chosen: false,   // by the viewer
  cop: new Series(4),          // x, y, load, pressed
  traces: new Map(),           // channel: Series of low, high, p2p
  images: [], imageBytes: 0,
  states: new Steps(),         // by channel: {state, p2p}
  registers: new Steps(),
  events: [], health: new Map(), statistics: new Map(), counts: {}, status: {}, dropped: 0,
  get from() {  // in the first seconds, what there is
    const {to, span, paused} = this.view;
    return paused ? to - span : Math.max(to - span, Math.min(0, to - 1));
  },
  get to() { return this.view.to; },
};

const panels = [], handlers = new Map();
export function panel(def) { panels.push(def); }
export function on(kind, take) { (handlers.get(kind) ?? handlers.set(kind, []).get(kind)).push(take); }
export const css = name => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
export const make = (tag, given = {}, ...children) => {
  const found = Object.assign(document.createElement(tag), given);
  found.append(...children);
  return found;
};
export const stateName = k => page.hello?.state_names[k] ?? `state ${k}`;
export const stateColour = k => css(["none", "contact", "incipient", "gross", "release"][k] ?? "none");
export const OF_LOAD = 65535;  // the channel of four electrodes
export const channelName = k => k === OF_LOAD ? "load" : `${k}`;
export const count = (n, noun) => `${n} ${noun}${n === 1 ? "" : "s"}`;
export const number = (value, digits = 4) => Number.isFinite(value) ? `${+value.toPrecision(digits)}` : "–";
export const fixed = (value, digits) => value.toFixed(digits).replace(/^-(0\.?0*)$/, "$1");
export function withUnit(value, scale) {  // a code in its unit, in milli where it is small
  if (!scale) return null;
  const amount = value * scale[0] + scale[1];
  return Math.abs(amount) < 1 && amount !== 0 ? `${number(1e3 * amount, 3)} m${scale[2]}` : `${number(amount)} ${scale[2]}`;
}
export const scaleOf = name => page.hello?.settings.find(setting => setting.name === name)?.scale ?? null;

export async function post(path, body) {
  const answer = await fetch(path, {method: "POST", headers: {"Content-Type": "application/json"}, body: JSON.stringify(body)});
  if (!answer.ok) throw new Error((await answer.json()).error);
  return answer;
}

// The stream

function forget() {
  for (const part of [page.cop, page.states, page.registers]) part.clear();
  for (const part of [page.traces, page.health, page.statistics]) part.clear();
  page.images = []; page.imageBytes = 0; page.events = []; page.newest = 0; page.counts = {}; page.dropped = 0;
  page.view.paused = false;
}

on("hello", head => {
  if (page.hello && page.hello.page !== head.page) return location.reload();
  if (page.hello && page.hello.session !== head.session) notice("meissner was started again: what came before is gone.");
  forget();
  page.hello = head;
  page.newest = head.t; page.first = head.first;
  document.getElementById("title").textContent = head.title;
  document.title = `${head.title} – Meissner`;
  for (const [channel, [state, p2p, since]] of Object.entries(head.now.states)) page.states.push(+channel, since, {state, p2p});
  for (const [taxel, faults] of Object.entries(head.now.health)) page.health.set(+taxel, faults);
  for (const [name, value] of Object.entries(head.now.statistics)) page.statistics.set(name, value);
  for (const [name, value] of Object.entries(head.now.register ?? {})) page.registers.push(name, head.since[name], value);
  link(head.now.link?.report);
  for (const def of panels) def.begin?.(head);
});
function link(address) {  // to the report of the scene that is played
  const found = document.getElementById("report");
  found.hidden = !address;
  if (address) found.href = address;
}
on("link", row => link(row.value));
on("CopFrame", row => page.cop.push(row.t, row.x_mm ?? row.x, row.y_mm ?? row.y, row.load_n ?? row.load, row.pressed));
on("Image", image => {
  page.images.push(image);
  page.imageBytes += image.taxels.byteLength;
  let first = 0;
  while (first < page.images.length - 1 && (page.imageBytes > KEPT_BYTES || page.images[first].t < image.t - KEPT_S)) {
    page.imageBytes -= page.images[first++].taxels.byteLength;
  }
  if (first) page.images.splice(0, first);
});
on("Trace", trace => {
  const [channels, spans] = trace.shapes.low;
  for (let c = 0; c < channels; c++) {
    const key = trace.first + c;
    const series = page.traces.get(key) ?? page.traces.set(key, new Series(3)).get(key);
    for (let k = 0; k < spans; k++) {
      const i = c * spans + k;
      series.push(trace.t + k * trace.step_s, trace.low[i], trace.high[i], trace.p2p[i]);
    }
  }
});
function event(t, text, state) {
  let at = page.events.length;
  while (at && page.events[at - 1].t > t) at--;
  page.events.splice(at, 0, {t, text, state});
  if (page.events.length > 500) page.events.splice(0, 250);
}
const whose = row => row.channel === OF_LOAD ? "load" : `channel ${row.channel}`;
const amount = row => row.channel === OF_LOAD ? `towards ${45 * row.p2p}°` : `peak-to-peak ${spread(row)}`;
const spread = row => row.p2p_v !== null ? `${number(1e3 * row.p2p_v, 3)} mV` : row.p2p_n !== null ? `${number(1e3 * row.p2p_n, 3)} mN` : `${row.p2p}`;
on("SlipEvent", row => {
  page.states.change(row.channel, row.t, {state: row.state, p2p: row.p2p}, {state: 1, p2p: null});  // a slip begins in contact
  event(row.t, `${whose(row)}: slip, ${stateName(row.state)}, ${amount(row)}`, row.state);
});
on("StateChange", row => {
  page.states.change(row.channel, row.t, {state: row.state, p2p: row.p2p}, {state: row.before, p2p: null});
  if ((page.hello.core.rows ?? 1) > 1 && !page.traces.size && row.state !== 2 && row.state !== 3) return;  // a press on an array changes too many
  event(row.t, `${whose(row)}: ${stateName(row.before)} to ${stateName(row.state)}`, row.state);
});
on("States", row => row.states.forEach((state, k) => {
  if (page.states.at(row.first + k, row.t)?.state !== state) page.states.push(row.first + k, row.t, {state, p2p: null});
}));
on("Health", row => {
  page.health.set(row.taxel, row.faults);
  event(row.t, `taxel ${row.taxel}: ${faults(row.faults)}`);
});
on("Statistics", row => page.statistics.set(page.hello.counters[row.index] ?? `counter ${row.index}`, row.value));
on("Gap", gap => event(gap.t, `interrupted for ${number(gap.seconds, 2)} s: ${gap.reason}`));
on("Reset", row => {
  event(row.t, "the core was reset");
  for (const channel of page.states.of.keys()) page.states.push(channel, row.t, {state: 0, p2p: null});
  page.health.clear(); page.statistics.clear();
});
on("message", row => event(row.t, row.text));
on("register", row => page.registers.change(row.name, row.t, row.value, row.before));
on("status", row => { page.status = row; page.counts = row.counts; });
on("dropped", row => { page.dropped = row.count; });
export const faults = bits => bits ? ["dead", "railed", "blinking"].filter((name, k) => name && bits >> k & 1).join(", ") || `faults ${bits}` : "works again";

const TYPES = {f8: Float64Array, f4: Float32Array, u1: Uint8Array, u2: Uint16Array, u4: Uint32Array, i4: Int32Array, i2: Int16Array};

function take(bytes) {  // one message, in a buffer of its own
  const view = new DataView(bytes), text = view.getUint32(4, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 16, text)));
  head.t = view.getFloat64(8, true);
  head.shapes = {};
  let at = 16 + text;
  for (const [name, kind, shape] of head.arrays ?? []) {
    const count = shape.reduce((a, b) => a * b, 1), type = TYPES[kind];
    if (type) head[name] = new type(bytes, at, count);
    head.shapes[name] = shape;
    at += Math.ceil(count * +kind.slice(1) / 8) * 8;
  }
  page.received++;
  if (head.t > page.newest) page.newest = head.t;
  const takers = handlers.get(head.kind) ?? [];
  if (!head.columns) return takers.forEach(taker => taker(head));
  const width = head.columns.length;
  for (let row = 0; row < head.rows.length; row += width) {
    const found = {};
    head.columns.forEach((name, k) => { const v = head.rows[row + k]; found[name] = Number.isNaN(v) ? null : v; });
    takers.forEach(taker => taker(found));
  }
}

async function read(stream) {
  const reader = stream.getReader();
  let rest = new Uint8Array(0);
  for (;;) {
    const {value, done} = await reader.read();
    if (done) return;
    let data = value;
    if (rest.length) { data = new Uint8Array(rest.length + value.length); data.set(rest); data.set(value, rest.length); }
    let at = 0;
    while (data.length - at >= 16) {
      const length = new DataView(data.buffer, data.byteOffset + at).getUint32(0, true);
      if (data.length - at < length) break;
      take(data.slice(at, at + length).buffer);
      at += length;
    }
    rest = data.slice(at);
  }
}

let connection = "wait";
async function connect() {
  for (let wait = 250; ; wait = Math.min(2 * wait, 4000)) {
    try {
      const answer = await fetch("/stream");
      if (!answer.ok) throw new Error((await answer.json()).error);
      connection = "live"; wait = 250;
      await read(answer.body);
      connection = "gone";
    } catch (problem) {
      connection = "gone";
      if (!(problem instanceof TypeError)) notice(problem.message);
    }
    await new Promise(done => setTimeout(done, wait));
  }
}

// Time and tools

let until = 0;
export function notice(text, seconds = 8) {
  const box = document.getElementById("notice");
  box.textContent = text;
  box.hidden = false;
  until = performance.now() + 1e3 * seconds;
}

export function show(from, to) {  // look at a part of the past
  page.view.paused = true;
  page.view.span = Math.max(0.01, to - from);
  page.view.to = to;
}
const oldest = () => Math.max(0, page.newest - KEPT_S);
function scrollTo(to) {
  if (!page.view.paused) page.view.span = to - page.from;
  page.view.paused = true;
  page.view.to = Math.min(page.newest, Math.max(oldest() + page.view.span, to));
}
function follow() { page.view.paused = false; }
function zoom(step) {
  const near = SPANS.findIndex(span => span >= page.view.span - 1e-9);
  page.view.span = SPANS[Math.max(0, Math.min(SPANS.length - 1, (near < 0 ? SPANS.length : near) + step))];
}
async function save() {
  const button = document.getElementById("save");
  button.disabled = true;
  try {
    const answer = await post("/save", {begin: page.from, end: page.to});
    const name = /"(.*)"/.exec(answer.headers.get("Content-Disposition"))[1];
    const link = make("a", {href: URL.createObjectURL(await answer.blob()), download: name});
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000);
    notice(`saved as ${name}`);
  } catch (problem) { notice(`not saved: ${problem.message}`); }
  button.disabled = false;
}
const KEYS = {
  " ": () => page.view.paused ? follow() : scrollTo(page.to), "ArrowLeft": () => scrollTo(page.to - page.view.span / 4),
  "ArrowRight": () => page.to + page.view.span / 4 >= page.newest ? follow() : scrollTo(page.to + page.view.span / 4),
  "+": () => zoom(-1), "=": () => zoom(-1), "-": () => zoom(1), "End": follow, "s": save, "S": save,
  "?": () => {
    const help = document.getElementById("help");
    help.hidden = !help.hidden;
    document.getElementById("keys").setAttribute("aria-expanded", !help.hidden);
  },
};

function tools() {
  const of = id => document.getElementById(id);
  of("span").append(...SPANS.map(span => make("option", {value: span, textContent: `${span} s`})), make("option", {value: "", textContent: "part", hidden: true}));
  of("pause").onclick = KEYS[" "];
  of("save").onclick = save;
  of("keys").onclick = KEYS["?"];
  of("span").onchange = () => { page.view.span = +of("span").value; };
  of("scroll").oninput = () => {
    const share = of("scroll").value / 1000;
    if (share === 1) follow(); else scrollTo(oldest() + page.view.span + share * (page.newest - page.view.span - oldest()));
  };
  addEventListener("keydown", press => {
    if (press.ctrlKey || press.metaKey || press.altKey) return;
    const inside = press.target.closest("input, select, textarea, button, summary");
    if (inside && (press.key === " " || press.key === "End" || press.key.startsWith("Arrow") || inside.type === "number")) return;
    if (KEYS[press.key]) { press.preventDefault(); KEYS[press.key](); }
  });
}

function head() {
  const of = id => document.getElementById(id), {view, status} = page;
  let state = "live", text = `${page.newest.toFixed(1)} s`;
  if (connection === "wait") [state, text] = ["wait", "connecting"];
  else if (connection === "gone") [state, text] = ["down", "meissner does not answer; trying again"];
  else if (status.down) [state, text] = ["down", "the core's line is interrupted; trying to open it again"];
  else if (status.ended) [state, text] = ["wait", `ended at ${text}`];
  if (of("state").textContent !== text) of("state").textContent = text;
  of("state").dataset.state = state;
  of("pause").setAttribute("aria-pressed", view.paused);
  of("pause").textContent = view.paused ? "Go on" : "Pause";
  of("span").value = SPANS.includes(view.span) ? view.span : "";
  of("at").textContent = view.paused ? `${page.from.toFixed(2)} – ${page.to.toFixed(2)} s` : "follows";
  const room = page.newest - view.span - oldest();
  if (document.activeElement !== of("scroll") || !view.paused) of("scroll").value = !view.paused || room <= 0 ? 1000 : 1000 * (page.to - view.span - oldest()) / room;
  if (performance.now() > until) of("notice").hidden = true;
}

let drawn = 0;
function draw(now) {
  requestAnimationFrame(draw);
  if (now - drawn < 30 || !page.hello) { if (!page.hello) head(); return; }
  drawn = now;
  if (!page.view.paused) page.view.to = page.newest;
  head();
  let empty = true;
  for (const def of panels) {
    const shown = def.shown?.() ?? true;
    if (shown && def.picture) empty = false;
    if (def.section.hidden === shown) def.section.hidden = !shown;
    if (shown) {
      def.draw?.();
      if (page.firstPicture === null && def.picture) page.firstPicture = performance.now();
    }
  }
  waits(empty);
}
function waits(empty) {  // what an empty page waits for
  const box = document.getElementById("empty"), packets = page.counts.packets ?? 0;
  let text = "Waiting for the first packet of the core. If none comes: is its converter on, and the line at its rate?";
  if (page.status.down) text = "Waiting until the core's line can be opened again.";
  else if (page.status.ended) text = "The source has ended, with nothing that could be drawn.";
  else if (packets) text = `${count(packets, "packet")} received. Waiting for one with an image, a centre of pressure, a channel's state or a class: does something touch the sensor?`;
  if (empty && box.textContent !== text) box.textContent = text;
  box.hidden = !empty;
}

// A canvas as wide as its panel, in the screen's own pixels.
export function canvas(body, height) {
  const found = make("canvas"), context = found.getContext("2d");
  body.append(found);
  return {
    element: found,
    begin(tall = height) {
      const ratio = devicePixelRatio || 1, wide = body.clientWidth;
      if (found.width !== Math.round(wide * ratio) || found.height !== Math.round(tall * ratio)) {
        found.width = Math.round(wide * ratio); found.height = Math.round(tall * ratio);
        found.style.width = `${wide}px`; found.style.height = `${tall}px`;
      }
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.clearRect(0, 0, wide, tall);
      return [context, wide, tall];
    },
  };
}

export const stepped = {paths: uPlot.paths.stepped({align: 1})};  // of a line of Steps.line

// A chart over the page's time. lines: {label, colour, ...} of uPlot's series; call it with the data to draw.
export function chart(body, lines, {height = 150, least = null, bands = []} = {}) {
  const font = "12px system-ui, sans-serif", tone = name => () => css(name);
  const options = {
    width: 300, height, pxAlign: false, legend: {show: false},
    cursor: {sync: {key: "time"}, drag: {x: true, y: false, setScale: false}, points: {show: false}},
    scales: {
      x: {time: false, range: () => [page.from, page.to]},
      y: {range: (_, low, high) => {
        if (low === null || !Number.isFinite(low)) return [0, 1];
        if (least !== null) low = Math.min(low, least);
        const room = high > low ? Math.max((high - low) * 0.08, Math.abs(high) * 1e-3) : Math.abs(high) / 10 || 1;
        return [least !== null && low >= least ? low : low - room, high + room];
      }},
    },
    axes: [
      {stroke: tone("soft"), grid: {stroke: tone("line"), width: 1}, ticks: {show: false}, font, size: 24, gap: 2, values: (_, ticks) => ticks.map(t => t < 0 ? "" : `${+t.toFixed(3)}`)},
      {stroke: tone("soft"), grid: {stroke: tone("line"), width: 1}, ticks: {show: false}, font, size: 58, gap: 4},
    ],
    series: [{}, ...lines.map(line => ({label: line.label, stroke: tone(line.colour), width: 1.4, points: {show: false}, ...line.more}))],
    bands: bands.map(([top, bottom, colour]) => ({series: [top, bottom], fill: tone(colour)})),
    hooks: {setSelect: [plot => {
      if (plot.select.width < 8) return;
      show(plot.posToVal(plot.select.left, "x"), plot.posToVal(plot.select.left + plot.select.width, "x"));
      plot.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
    }]},
  };
  const plot = new uPlot(options, [[], ...lines.map(() => [])], body);
  body.append(make("div", {className: "legend"}, ...lines.filter(line => line.label).map(line => {
    const dot = make("span", {className: "dot"});
    dot.style.background = `var(--${line.colour})`;
    return make("span", {}, dot, line.label);
  })));
  return (data, tall = height) => {
    const wide = body.clientWidth;
    if (wide && (plot.width !== wide || plot.height !== tall)) plot.setSize({width: wide, height: tall});
    plot.setData(data);
  };
}

addEventListener("DOMContentLoaded", () => {
  const main = document.getElementById("panels");
  for (const def of panels) {
    const title = make("h2", {textContent: def.title}), body = make("div");
    def.section = make("section", {hidden: true, id: def.id, className: def.shape ?? ""}, title, body);
    main.append(def.section);
    def.build(body, title);
  }
  tools();
  connect();
  requestAnimationFrame(draw);
});
window.meissner = page;
