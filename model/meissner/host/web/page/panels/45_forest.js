// A forest's class over time, and the votes for it.
import {chart, make, on, page, panel, Series} from "/page.js";

const classes = new Series(2);
let label, votes, sub;

on("ClassChange", row => classes.push(row.t, row.label, row.votes / 65535));

panel({
  id: "forest", title: "Class of the forest",
  shown: () => classes.length > 0 || page.registers.now("forest.best") > 0,
  begin() { classes.clear(); },
  build(body, title) {
    sub = title.appendChild(make("small"));
    label = chart(body, [{label: "class", colour: "accent", more: {paths: uPlot.paths.stepped({align: 1})}}], {least: 0, height: 110});
    votes = chart(body, [{label: "votes for it, in trees", colour: "second", more: {paths: uPlot.paths.stepped({align: 1})}}], {least: 0, height: 110});
  },
  draw() {
    const [t, value, trees] = classes.thin(page.from, page.to, [[1, "last"], [2, "last"]]).map(column => [...column]);
    if (t.length) { t.push(page.to); value.push(value.at(-1)); trees.push(trees.at(-1)); }
    label([t, value]);
    votes([t, trees]);
    const now = value.at(-1) ?? page.registers.now("forest.label");
    sub.textContent = `class ${now}`;
  },
});
