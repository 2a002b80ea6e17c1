// The pins of a tactile display, as the core makes them of its images.
import {canvas, css, make, on, panel} from "/page.js";

let surface, sub, frame = null, told = "";

on("Pins", pins => { frame = pins; });
on("display", row => { told = row.value; });

panel({
  id: "pins", title: "Pin display",
  shown: () => frame !== null,
  begin(hello) { frame = null; told = hello.now.display?.told ?? ""; },
  build(body, title) {
    sub = title.appendChild(make("small"));
    surface = canvas(body, 200);
  },
  draw() {
    const [rows, columns] = frame.shapes.levels, width = surface.element.parentElement.clientWidth;
    const [draw, wide, tall] = surface.begin(Math.min(300, width * rows / columns));
    const cell = Math.min(wide / columns, tall / rows), left = (wide - cell * columns) / 2;
    frame.levels.forEach((level, k) => {
      draw.beginPath();
      draw.arc(left + cell * (k % columns + 0.5), cell * (Math.floor(k / columns) + 0.5), cell * 0.38, 0, 7);
      draw.fillStyle = css("none"); draw.globalAlpha = 1; draw.fill();
      draw.fillStyle = css("accent"); draw.globalAlpha = level / frame.most; draw.fill();
    });
    draw.globalAlpha = 1;
    sub.textContent = told;
  },
});
