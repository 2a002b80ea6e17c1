// A channel's signal, and its peak-to-peak against the thresholds. A line carries no samples: the signal is that of a
// core in this process, or a taxel of the images; the peak-to-peak of other cores is that of its changes of state.
import {channelName, chart, make, page, panel, scaleOf, stateName, withUnit} from "/page.js";

let signal, spread, choice, sub, note;

function taxels() {  // the channel's taxel in the images, as [t, value]
  const {images, channel} = page, unit = page.hello.core.newtons_per_code ?? 1;
  const first = Math.max(0, images.findIndex(image => image.t >= page.from) - 1), found = [[], []];
  if (images.length && images.at(-1).t < page.from) return found;
  for (let k = first; k < images.length && images[k].t <= page.to + 1; k++) {
    if (channel >= images[k].taxels.length) break;
    found[0].push(images[k].t); found[1].push(images[k].taxels[channel] * unit);
  }
  return found;
}

function thresholds(t) {
  return ["slip.threshold", "slip.keep_threshold", "slip.gross_threshold"].map(name => {
    const out = new Array(t.length), first = page.registers.now(name);
    if (first === undefined) return out.fill(null);
    for (let k = 0; k < t.length; k++) out[k] = page.registers.at(name, t[k]);
    return out;
  });
}

panel({
  id: "signal", title: "Slip of a channel", shape: "wide", picture: true,
  shown: () => page.traces.size > 0 || page.images.length > 0 || page.states.of.size > 0,
  build(body, title) {
    sub = title.appendChild(make("small"));
    choice = make("select");
    title.append(make("label", {}, "channel ", choice));
    choice.onchange = () => { page.channel = +choice.value; };
    signal = chart(body, [{label: "signal", colour: "accent", more: {width: 1}}, {label: "", colour: "accent", more: {width: 1}}], {bands: [[2, 1, "accent"]], height: 140});
    spread = chart(body, [
      {label: "peak-to-peak", colour: "second"}, {label: "threshold", colour: "incipient", more: {width: 2, dash: [8, 3]}},
      {label: "keeps a flag", colour: "release", more: {dash: [2, 3]}}, {label: "gross", colour: "gross", more: {width: 2, dash: [8, 3]}},
    ], {least: 0, height: 170});
    note = body.appendChild(make("p", {className: "note"}));
  },
  draw() {
    const known = [...new Set([...page.traces.keys(), ...page.states.of.keys(), page.channel])].sort((a, b) => a - b).slice(0, 300);
    if (!known.includes(page.channel)) known.push(page.channel);
    const key = known.join();
    if (choice.dataset.key !== key) {
      choice.dataset.key = key;
      choice.replaceChildren(...known.map(channel => make("option", {value: channel, textContent: channelName(channel)})));
    }
    choice.value = page.channel;
    const trace = page.traces.get(page.channel);
    const scale = scaleOf("slip.threshold");
    let said = "", t, p2p;
    if (trace) {
      const data = trace.thin(page.from, page.to, [[1, "min"], [2, "max"], [3, "max"]]);
      signal(data.slice(0, 3));
      [t, , , p2p] = data;
      said = "codes";
    } else {
      const [at, value] = taxels();
      signal([at, value, value]);
      const list = (page.states.of.get(page.channel) ?? []).filter(one => one.p2p !== null && one.t >= page.from - 60 && one.t <= page.to + 1);
      t = list.map(one => one.t); p2p = list.map(one => one.p2p);
      said = `the line carries no samples: ${at.length ? "the signal is that of the images, " : ""}the peak-to-peak that of each change of state`;
    }
    // Gross and keep are drawn only where they lie in reach of what is seen: at rest they are at their largest.
    const ends = [page.from, ...t, page.to], rows = thresholds(ends), seen = Math.max(8, ...p2p, ...rows[0].filter(Number.isFinite).slice(-1));
    const lines = rows.map((row, k) => row.map(value => k && (value === null || value > 4 * seen) ? null : value > 4 * seen ? 4 * seen : value));
    spread([ends, [null, ...p2p, null], ...lines]);
    const state = page.states.at(page.channel, page.to), threshold = page.registers.at("slip.threshold", page.to);
    sub.textContent = `${stateName(state?.state ?? 0)}${threshold === undefined ? "" : `, threshold ${threshold}${scale ? ` (${withUnit(threshold, scale)})` : ""}`}`;
    note.textContent = said === "codes" ? "in codes; of the peak-to-peak, those of the detail" : said;
  },
});
