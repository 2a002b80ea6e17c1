// A channel's signal, and its peak-to-peak against the thresholds. A line carries no samples: the signal is that of a
// core in this process, a taxel of the images or the load of four electrodes; the peak-to-peak of other cores is that of
// their changes of state.
import {channelName, chart, make, OF_LOAD, page, panel, scaleOf, stateName, withUnit} from "/page.js";

const THRESHOLDS = ["slip.threshold", "slip.keep_threshold", "slip.gross_threshold"];
let signal, spread, upper, lower, choice, heading, sub, note;

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

function strongest() {  // the taxel that is pressed most when something first presses
  const {images, cop} = page;
  if (cop.length && !cop.columns[4][cop.length - 1]) return undefined;
  const taxels = images.at(-1)?.taxels ?? [], most = taxels.reduce((a, b) => Math.max(a, b), 0);
  if (!most) return undefined;
  page.chosen = true;
  return taxels.indexOf(most);
}

function against(t, p2p) {  // the peak-to-peak and the thresholds, with the times at which one of these changed
  const at = [...t], values = [...p2p];
  const changes = THRESHOLDS.flatMap(name => (page.registers.of.get(name) ?? []).map(one => one.t));
  for (const mark of [page.from, page.to, ...changes.filter(t => t > page.from && t < page.to)]) {
    let k = at.length;
    while (k && at[k - 1] > mark) k--;
    if (at[k - 1] !== mark) { at.splice(k, 0, mark); values.splice(k, 0, null); }
  }
  // Gross and keep are drawn only where they lie in reach of what is seen: at rest they are at their largest.
  const rows = THRESHOLDS.map(name => at.map(t => page.registers.at(name, t) ?? null));
  const most = 4 * Math.max(8, ...p2p, ...rows[0].slice(-1));
  return [at, values, ...rows.map((row, k) => row.map(value => value === null || value <= most ? value : k ? null : most))];
}

panel({
  id: "signal", title: "Slip of a channel", shape: "wide", picture: true,
  shown: () => page.traces.size > 0 || page.images.length > 0 || page.states.of.size > 0,
  build(body, title) {
    heading = title.firstChild;
    sub = title.appendChild(make("small"));
    choice = make("select");
    title.append(make("label", {}, "channel ", choice));
    choice.onchange = () => { [page.channel, page.chosen] = [+choice.value, true]; };
    upper = body.appendChild(make("div")); lower = body.appendChild(make("div"));
    signal = chart(upper, [{label: "signal", colour: "accent", more: {width: 1}}, {label: "", colour: "accent", more: {width: 1}}], {bands: [[2, 1, "accent"]], height: 140});
    const stepped = uPlot.paths.stepped({align: 1});
    spread = chart(lower, [
      {label: "peak-to-peak", colour: "second", more: {spanGaps: true}}, {label: "threshold", colour: "incipient", more: {width: 2, dash: [8, 3], paths: stepped}},
      {label: "keeps a flag", colour: "release", more: {dash: [2, 3], paths: stepped}}, {label: "gross", colour: "gross", more: {width: 2, dash: [8, 3], paths: stepped}},
    ], {least: 0, height: 170});
    note = body.appendChild(make("p", {className: "note"}));
  },
  draw() {
    const known = [...new Set([...page.traces.keys(), ...page.states.of.keys()])].sort((a, b) => a - b).slice(0, 300);
    if (!page.chosen) page.channel = (page.traces.size ? undefined : strongest()) ?? known[0] ?? 0;
    if (!known.includes(page.channel)) known.push(page.channel);
    const key = known.join();
    if (choice.dataset.key !== key) {
      choice.dataset.key = key;
      choice.replaceChildren(...known.map(channel => make("option", {value: channel, textContent: channelName(channel)})));
    }
    choice.value = page.channel;
    const trace = page.traces.get(page.channel), ofLoad = page.channel === OF_LOAD;
    let said, drawn, t = [], p2p = [];
    if (trace) {
      const data = trace.thin(page.from, page.to, [[1, "min"], [2, "max"], [3, "max"]]);
      drawn = data.slice(0, 3);
      [t, , , p2p] = data;
      said = "in codes; of the peak-to-peak, those of the detail";
    } else if (ofLoad) {
      drawn = page.images.length ? [[]] : page.cop.thin(page.from, page.to, [[3, "min"], [3, "max"]]);
      said = `${page.images.length ? "" : "the signal is the load of the four electrodes; "}a slip is a fall of that load while the centre moves`;
    } else {
      const [at, value] = taxels(), list = (page.states.of.get(page.channel) ?? []).filter(one => one.value.p2p !== null && one.t >= page.from - 60 && one.t <= page.to + 1);
      drawn = [at, value, value];
      t = list.map(one => one.t); p2p = list.map(one => one.value.p2p);
      said = [at.length ? "the signal is that of the images" : "", t.length ? "the peak-to-peak is that of each change of state" : ""].filter(Boolean).join(", ");
      said = `the line carries no samples${said ? `: ${said}` : ""}`;
    }
    upper.hidden = !drawn[0].length;
    lower.hidden = ofLoad || !(p2p.length || THRESHOLDS.some(name => page.registers.of.has(name)));
    if (!upper.hidden) signal(drawn, lower.hidden ? 280 : 140);
    if (!lower.hidden) spread(against(t, p2p));
    const state = page.states.at(page.channel, page.to), threshold = ofLoad ? undefined : page.registers.at("slip.threshold", page.to);
    const unit = threshold === undefined ? null : withUnit(threshold, scaleOf("slip.threshold"));
    heading.nodeValue = page.states.of.size || trace ? "Slip of a channel" : "Signal of a channel";
    const words = [state ? stateName(state.state) : "", threshold === undefined ? "" : `threshold ${threshold}${unit ? ` (${unit})` : ""}`];
    sub.textContent = words.filter(Boolean).join(", ");
    note.textContent = said;
  },
});
