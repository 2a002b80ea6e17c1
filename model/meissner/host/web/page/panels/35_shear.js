// The speed of shear of a channel, as its register says it: twins.slip.shear_speed has the flags.
import {chart, make, page, panel, stepped} from "/page.js";

const FLAGS = ["unsettled", "out of range", "too small", "no denominator", "clipped", "still rising", "too fast", "saturated"];
let plot, sub, note;
const name = () => `shear_speed.channel${page.registers.of.has(`shear_speed.channel${page.channel}`) ? page.channel : 0}`;
const speed = word => word >>> 24 ? null : (word & 0xffffff) / (1 << 20);

panel({
  id: "shear", title: "Speed of shear", picture: true,
  shown: () => Boolean(page.registers.now("shear_speed.enable")) && page.registers.of.has(name()),
  build(body, title) {
    sub = title.appendChild(make("small"));
    plot = chart(body, [{label: "", colour: "second", more: stepped}], {least: 0});
    note = body.appendChild(make("p", {className: "note"}));
  },
  draw() {
    plot(page.registers.line(name(), page.from, page.to, speed));
    const word = page.registers.at(name(), page.to);
    const flags = word === undefined ? [] : FLAGS.filter((_, k) => word >>> 24 >> k & 1);
    sub.textContent = word === undefined || flags.length ? "" : `${speed(word).toPrecision(3)} mm/s`;
    note.textContent = flags.length ? `no speed: ${flags.join(", ")}` : "of the last window";
  },
});
