// The grip reflex: its command and its faults, as the registers say them.
import {chart, count, make, page, panel, stepped} from "/page.js";

const FAULTS = ["a finger is silent", "a finger is unhealthy", "command at its maximum", "minimum above maximum", "no command yet"];
let plot, words, sub;

panel({
  id: "grip", title: "Grip command", picture: true,
  shown: () => Boolean(page.registers.now("grip.enable") || page.registers.now("grip.command")),
  build(body, title) {
    sub = title.appendChild(make("small"));
    plot = chart(body, [{label: "", colour: "second", more: stepped}], {least: 0});
    words = body.appendChild(make("p", {className: "note"}));
  },
  draw() {
    plot(page.registers.line("grip.command", page.from, page.to));
    const command = page.registers.at("grip.command", page.to);
    sub.textContent = command === undefined ? "" : count(command, "count");
    const bits = page.registers.at("grip.fault", page.to) ?? 0, fingers = page.registers.at("grip.faulty", page.to) ?? 0;
    const said = FAULTS.filter((_, k) => bits >> k & 1);
    const out = [...Array(8).keys()].filter(k => fingers >> k & 1);
    if (out.length) said.push(`finger${out.length > 1 ? "s" : ""} left out: ${out.join(", ")}`);
    words.textContent = `${said.join(", ") || "no fault"}; ${count(page.registers.at("grip.tightenings", page.to) ?? 0, "tightening")}`;
  },
});
