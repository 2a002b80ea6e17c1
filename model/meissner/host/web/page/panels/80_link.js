// The line's counters, and the core's own.
import {make, page, panel} from "/page.js";

const NAMES = {packets: "packets", lost: "packets lost", damaged: "damaged", images_lost: "images lost", images_unfit: "images of another size", unknown: "of unknown types", gaps: "interruptions", restarts: "resets of the core", retries: "commands sent again", unread: "dropped, this machine was too slow"};
const ALWAYS = ["packets", "lost", "damaged", "images_lost"];
let table, before = null, rate = 0, key = "";

panel({
  id: "link", title: "Link",
  build(body) { table = body.appendChild(make("table")); },
  draw() {
    const now = performance.now(), {counts} = page;
    if (!before || now - before.at > 1000) {
      if (before && counts.packets >= before.packets) rate = 1000 * (counts.packets - before.packets) / (now - before.at);
      before = {at: now, packets: counts.packets ?? 0};
    }
    const rows = Object.entries(NAMES).filter(([name]) => ALWAYS.includes(name) || counts[name]).map(([name, text]) => [text, counts[name] ?? "–"]);
    rows.splice(1, 0, ["packets a second", Math.round(rate)]);
    const counted = [...page.statistics].filter(([, value]) => value);
    for (const [name, value] of counted) rows.push([`in the core: ${name}`, value]);
    if (page.statistics.size) rows.push([counted.length ? "in the core: all other counters" : "in the core: all counters", 0]);
    rows.push(["viewers", page.status.viewers ?? 1]);
    if (page.dropped) rows.push(["parts dropped: this viewer is too slow", page.dropped]);
    const next = rows.join();
    if (next === key) return;
    key = next;
    table.replaceChildren(...rows.map(([text, value]) => make("tr", {}, make("th", {textContent: text}), make("td", {textContent: value}))));
  },
});
