// The load over time.
import {chart, make, page, panel} from "/page.js";

let load, sub;

panel({
  id: "load", title: "Load", picture: true,
  shown: () => page.cop.length > 0,
  build(body, title) {
    sub = title.appendChild(make("small"));
    load = chart(body, [{label: "", colour: "accent"}, {label: "", colour: "accent"}], {least: 0, bands: [[2, 1, "accent"]]});
  },
  draw() {
    load(page.cop.thin(page.from, page.to, [[3, "min"], [3, "max"]]));
    sub.textContent = page.hello.core.newtons_per_code ? "newtons" : "sum of forces, in codes";
  },
});
