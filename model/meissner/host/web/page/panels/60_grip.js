// The grip reflex: its command and its faults, as the registers say them.
import {chart, make, page, panel} from "/page.js";

const FAULTS = ["a finger is silent", "a finger is unhealthy", "command at its maximum", "minimum above maximum", "no command yet"];
let plot, words, sub;

panel({
  id: "grip", title: "Grip command",
  shown: () => Boolean(page.registers.now("grip.enable") || page.registers.now("grip.command")),
  build(body, title) {
    sub = title.appendChild(make("small"));
    plot = chart(body, [{label: "", colour: "second"}], {least: 0});
    words = body.appendChild(make("p", {className: "note"}));
  },
  draw() {
    const list = page.registers.of.get("grip.command"), t = [], values = [];
    for (const one of list) {  // steps: each value until the next
      if (t.length) { t.push(one.t); values.push(values.at(-1)); }
      t.push(one.t); values.push(one.value);
    }
    t.push(page.newest); values.push(values.at(-1));
    plot([t, values]);
    sub.textContent = `${page.registers.at("grip.command", page.to)} counts`;
    const bits = page.registers.at("grip.fault", page.to) ?? 0, fingers = page.registers.at("grip.faulty", page.to) ?? 0;
    const said = FAULTS.filter((_, k) => bits >> k & 1);
    if (fingers) said.push(`fingers left out: ${[...Array(8).keys()].filter(k => fingers >> k & 1).join(", ")}`);
    words.textContent = `${said.join(", ") || "no fault"}; ${page.registers.at("grip.tightenings", page.to) ?? 0} tightenings`;
  },
});
