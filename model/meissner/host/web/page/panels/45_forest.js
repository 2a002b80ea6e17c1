// A forest's class over time, and the votes for it.
import {chart, make, on, page, panel, stepped, Steps} from "/page.js";

const classes = new Steps();
let label, votes, sub;

on("ClassChange", row => classes.change("now", row.t, [row.label, row.votes / 65535], row.before === null ? null : [row.before, null]));

panel({
  id: "forest", title: "Class of the forest", picture: true,
  shown: () => classes.of.size > 0 || page.registers.now("forest.best") > 0,
  begin(hello) {
    classes.clear();
    const {decided} = hello.now;
    if (decided) classes.push("now", decided.t, [decided.label, decided.votes / 65535]);
  },
  build(body, title) {
    sub = title.appendChild(make("small"));
    label = chart(body, [{label: "class", colour: "accent", more: stepped}], {least: 0, height: 110});
    votes = chart(body, [{label: "votes for it, in trees", colour: "second", more: stepped}], {least: 0, height: 110});
  },
  draw() {
    label(classes.line("now", page.from, page.to, one => one[0]));
    votes(classes.line("now", page.from, page.to, one => one[1]));
    const now = classes.at("now", page.to)?.[0] ?? page.registers.at("forest.label", page.to);
    sub.textContent = now === undefined ? "" : `class ${now}`;
  },
});
