// The pins of a tactile display, as the core makes them of its images.
import {canvas, css, make, on, page, panel, Steps} from "/page.js";

const frames = new Steps(), told = new Steps();
let surface, sub;

on("Pins", pins => frames.push("now", pins.t, pins));
on("display", row => told.change("now", row.t, row.value, row.before));

panel({
  id: "pins", title: "Pin display", picture: true,
  shown: () => frames.of.size > 0,
  begin(hello) {
    frames.clear(); told.clear();
    if (hello.now.display) told.push("now", hello.t, hello.now.display.told);
  },
  build(body, title) {
    sub = title.appendChild(make("small"));
    surface = canvas(body, 200);
  },
  draw() {
    const frame = frames.at("now", page.to);
    if (!frame) return;
    const [rows, columns] = frame.shapes.levels, width = surface.element.parentElement.clientWidth;
    const [draw, wide, tall] = surface.begin(Math.min(300, width * rows / columns));
    const cell = Math.min(wide / columns, tall / rows), left = (wide - cell * columns) / 2, top = (tall - cell * rows) / 2;
    frame.levels.forEach((level, k) => {
      draw.beginPath();
      draw.arc(left + cell * (k % columns + 0.5), top + cell * (Math.floor(k / columns) + 0.5), cell * 0.38, 0, 7);
      draw.fillStyle = css("none"); draw.globalAlpha = 1; draw.fill();
      draw.fillStyle = css("accent"); draw.globalAlpha = level / frame.most; draw.fill();
    });
    draw.globalAlpha = 1;
    sub.textContent = told.at("now", page.to) ?? "";
  },
});
